#include <gazebo/gazebo.hh>
#include <gazebo/physics/physics.hh>
#include <gazebo/common/common.hh>
#include <ignition/math.hh>

namespace gazebo
{
  class m : public ModelPlugin
  {
    public: void Load(physics::ModelPtr _parent, sdf::ElementPtr)
    {
      common::PoseAnimationPtr anim(new common::PoseAnimation("m", 1e, true));
      common::PoseKeyFrame *key;
      key = anim->CreateKeyFrame(0.00);
      key->Translation(ignition::math::Vector3d(1.00, 2.00, 0));
      key->Rotation(ignition::math::Quaterniond(0, 0, 0));
      key = anim->CreateKeyFrame(2.00);
      key->Translation(ignition::math::Vector3d(3.00, 2.00, 0));
      key->Rotation(ignition::math::Quaterniond(0, 0, 0));
      key = anim->CreateKeyFrame(5.00);
      key->Translation(ignition::math::Vector3d(4.00, 1.00, 0));
      key->Rotation(ignition::math::Quaterniond(0, 0, 0));
      _parent->SetAnimation(anim);
    }
  };
  GZ_REGISTER_MODEL_PLUGIN(m)
}
