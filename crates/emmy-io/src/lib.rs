//! Files of Emmy: the input, meshes of other programs, and results.
