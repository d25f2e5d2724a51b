// Empty on purpose: CMake writes the precompiled header at the first configure only for a target with a source that
// uses it, and main.cpp does not.
