#pragma once

#include <span>
#include <string>
#include <string_view>

namespace filasofia::runtime {

/// What a person can do in the window of a live run, one line each. The help on the screen, the help of the commands
/// and the documentation are made of these lines.
struct KeyLine {
    std::string_view keys;    ///< "F12, P"
    std::string_view meaning; ///< "write a picture into the working folder"
};
std::span<const KeyLine> keyLines();

/// The lines as text, with keys and meanings in columns.
std::string keyHelp();

} // namespace filasofia::runtime
