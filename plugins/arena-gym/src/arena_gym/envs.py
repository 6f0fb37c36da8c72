"""Registers the environments with gymnasium when imported; the plugin itself must not load
gymnasium for every ``arena`` command.
"""

import gymnasium

gymnasium.register(
    id="arena/Navigation-v0",
    entry_point="arena_gym.environment:NavigationEnv",
    vector_entry_point="arena_gym.vector_environment:NavigationVectorEnv",
)
