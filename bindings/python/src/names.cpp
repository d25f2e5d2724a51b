#include "names.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace filasofia::python {
namespace {

bool isUpper(char letter) { return std::isupper(static_cast<unsigned char>(letter)) != 0; }
bool isLower(char letter) { return std::islower(static_cast<unsigned char>(letter)) != 0; }
bool isPart(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }

/// Fields and functions begin with a small letter, types and units such as "N" with a capital.
bool isCamel(std::string_view word) { return isLower(word.front()) && std::ranges::any_of(word, isUpper); }

} // namespace

std::string snakeCase(std::string_view camel)
{
    constexpr std::array<std::string_view, 32> kGrammar = {
        "and",      "as",     "assert",  "async", "await", "break",  "class", "continue", "def",  "del",  "elif",
        "else",     "except", "finally", "for",   "from",  "global", "if",    "import",   "in",   "is",   "lambda",
        "nonlocal", "not",    "or",      "pass",  "raise", "return", "try",   "while",    "with", "yield"};
    std::string out;
    for (const char letter : camel) {
        if (isUpper(letter) && !out.empty()) out += '_';
        out += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    if (std::ranges::find(kGrammar, out) != kGrammar.end()) out += '_';
    return out;
}

std::string pythonic(std::string_view line)
{
    std::string out;
    bool quoted = false;
    while (!line.empty()) {
        const auto end =
            std::min(line.size(), static_cast<std::size_t>(std::ranges::find_if_not(line, isPart) - line.begin()));
        if (end == 0) { // between words
            quoted ^= line.front() == '\'';
            out += line.front();
            line.remove_prefix(1);
            continue;
        }
        const std::string_view word = line.substr(0, end);
        const bool path = (!out.empty() && out.back() == '/') || (end < line.size() && line[end] == '/');
        out += quoted || path || !isCamel(word) ? std::string(word) : snakeCase(word);
        line.remove_prefix(end);
    }
    return out;
}

} // namespace filasofia::python
