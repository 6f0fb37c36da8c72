"""Build what rclpy needs of arena-ros's own interface definitions: Nav2's packages are on no index of Python's.

usage: build_interfaces.py WHEELS, the folder of ROS 2's wheels; needs a C and a C++ compiler.
"""

import contextlib
import io
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

DEFINITIONS = Path(__file__).resolve().parents[1] / "plugins/arena-ros/src/arena_ros/interfaces"
SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
PACKAGES = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"


def generate_sources(package, wheels, out):
    """Write C, C++ and Python of a package's definitions; each generator has a folder in ``out``."""
    from rosidl_adapter import convert_to_idl
    from rosidl_generator_c.cli import GenerateC
    from rosidl_generator_py.cli import GeneratePython
    from rosidl_generator_type_description.cli import HashTypeDescription
    from rosidl_typesupport_c.cli import GenerateCTypesupport
    from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
    from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

    share, files = [str(wheels / "share")], []
    for file in sorted((DEFINITIONS / package).glob("*/*.*")):
        kind = file.parent.name
        with contextlib.redirect_stdout(io.StringIO()):  # it tells what it reads and writes
            convert_to_idl(DEFINITIONS / package, package, Path(kind, file.name), out / "idl")
        files.append(f"{out / 'idl'}:{kind}/{file.stem}.idl")
    generators = {
        "fastrtps_c": GenerateFastRTPSCTypesupport("fastrtps_c"),
        "introspection_c": GenerateIntrospectionCTypesupport("introspection_c"),
        "typesupport_c": GenerateCTypesupport("c", typesupport_implementations=SUPPORTS),
        "generator_py": GeneratePython("py", typesupport_implementations=["rosidl_typesupport_c"]),
    }
    for name, generator in generators.items():
        generator.generate(package, files, share, out / name / package)
    target = out / "generator_c" / package
    hashes = HashTypeDescription("hash").generate_type_hashes(package, files, share, target)
    GenerateC("c").generate(package, files, share, target, hashes)


def compile_libraries(package, wheels, out):
    """Compile a package's sources, one library for each generator, and put them beside the wheels."""
    module = Path(PACKAGES, package, f"{package}_s__rosidl_typesupport_c{sysconfig.get_config_var('EXT_SUFFIX')}")
    own = f"lib/lib{package}__rosidl"
    parts = [  # target, the generator whose sources it is made of, their endings, and what of other packages it calls
        (f"{own}_generator_c.so", "generator_c", "*/detail/*.c", "generator_c"),
        (f"{own}_typesupport_introspection_c.so", "introspection_c", "*/detail/*.c", "introspection_c"),
        (f"{own}_typesupport_fastrtps_c.so", "fastrtps_c", "*/detail/*.cpp", "fastrtps_c"),
        (f"{own}_typesupport_c.so", "typesupport_c", "*/*.cpp", "typesupport_c"),
        (f"{own}_generator_py.so", "generator_py", "*/_*_s.c", "generator_py"),
        (str(module), "generator_py", f"_{package}_s.ep.*.c", "generator_py"),
    ]
    numpy = next(wheels.glob("numpy/_core/include"))
    includes = [numpy, sysconfig.get_path("include"), wheels / "include", *wheels.glob("include/*"), *out.iterdir()]
    flags = ["-O1", "-w", "-fPIC", "-shared", f'-DROS_PACKAGE_NAME="{package}"', *(f"-I{path}" for path in includes)]
    module = wheels / module
    module.parent.mkdir(parents=True, exist_ok=True)
    for target, generator, pattern, ending in parts:
        sources = sorted((out / generator / package).glob(pattern))
        called = {
            path for each in (ending, "generator_c", "typesupport_c") for path in wheels.glob(f"lib/lib*_{each}.so")
        }
        links = [f"-l{path.stem.removeprefix('lib')}" for path in sorted(called) if path != wheels / target]
        links += ["-lrosidl_runtime_c", "-lrosidl_typesupport_fastrtps_cpp", "-lfastcdr", "-lrmw", "-lrcutils"]
        linking = [f"-L{wheels}/lib", "-Wl,--as-needed", *links]
        compiler = ["g++" if "cpp" in pattern else "gcc", *flags]
        subprocess.run([*compiler, "-o", wheels / target, *sources, *linking], check=True)  # noqa: S603
    for path in (out / "generator_py" / package).glob("*/*.py"):
        (module.parent / path.parent.name).mkdir(exist_ok=True)
        shutil.copy(path, module.parent / path.parent.name)
    (module.parent / "__init__.py").touch()


def main(wheels):
    """Build each package."""
    os.environ["AMENT_PREFIX_PATH"] = str(wheels)
    sys.path[:0] = [str(wheels / PACKAGES), str(wheels)]
    for package in sorted(path.name for path in DEFINITIONS.iterdir() if path.is_dir()):
        with tempfile.TemporaryDirectory() as folder:
            generate_sources(package, wheels, Path(folder))
            compile_libraries(package, wheels, Path(folder))


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
