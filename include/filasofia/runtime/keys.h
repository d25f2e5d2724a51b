#pragma once

#include <span>
#include <string>
#include <string_view>

namespace filasofia::runtime {

/// What a person can do in the window of a live run, a line each: the help on the screen, that of the commands and the
/// documentation are all made of these.
struct KeyLine {
    std::string_view keys;    ///< "F12, P"
    std::string_view meaning; ///< "write a picture into the working folder"
};
std::span<const KeyLine> keyLines();

/// The lines as text, keys and meanings in columns.
std::string keyHelp();

} // namespace filasofia::runtime
