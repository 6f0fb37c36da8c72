"""From YAML to components: plugins, registry, composition, binding of numbers to constructors."""
