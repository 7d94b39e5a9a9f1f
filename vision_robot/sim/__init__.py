"""MuJoCo: which OpenGL, pictures with exact truth, and the scenes they show."""
