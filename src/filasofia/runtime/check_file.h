#pragma once

#include <string>

namespace filasofia::runtime {

/// Fails before the run instead of after it: an Error "<object>: <field> ..." if the file cannot be written there. An
/// empty name means no file.
void checkFile(const char* object, const std::string& file, const char* field, const char* extension);

} // namespace filasofia::runtime
