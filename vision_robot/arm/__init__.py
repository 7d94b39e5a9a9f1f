"""Arms: models from files, inverse kinematics, C for a microcontroller."""
