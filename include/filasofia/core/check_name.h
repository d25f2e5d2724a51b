#pragma once

#include <string_view>

namespace filasofia {

/// Throws an Error "<object>: name must ..." unless a name can be read in a line of text: it has a visible letter, is
/// UTF-8, and has neither control characters nor marks that turn the direction of what follows (U+200E, U+200F, U+202A
/// to U+202E, U+2066 to U+2069).
void checkName(std::string_view name, std::string_view object);

} // namespace filasofia
