#include "names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

namespace filasofia::python {
namespace {

bool isUpper(char letter) { return std::isupper(static_cast<unsigned char>(letter)) != 0; }
bool isLower(char letter) { return std::islower(static_cast<unsigned char>(letter)) != 0; }
bool isPart(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }

/// Fields and functions begin with a small letter, types and units such as "N" with a capital.
bool isCamel(std::string_view word) { return isLower(word.front()) && std::ranges::any_of(word, isUpper); }

std::set<std::string>& ownNames()
{
    static std::set<std::string> names;
    return names;
}

/// Whether a word is ours: users' names, those in their files, and what Python does not have stay as they are.
bool isOwn(std::string_view word) { return isCamel(word) && ownNames().contains(snakeCase(word)); }

/// Behind the quotation that the line begins with; 0 if it begins with none. A mark inside a word ends nothing: names
/// may have apostrophes.
std::size_t quotationEnd(std::string_view line)
{
    const char mark = line.front();
    if (mark != '\'' && mark != '"') return 0;
    for (std::size_t i = 1; i < line.size(); ++i)
        if (line[i] == mark && (i + 1 == line.size() || !isPart(line[i + 1]))) return i + 1;
    return 0;
}

/// Whether a word between spaces is the name of a file: it has a folder, or an extension that the engine knows.
bool isFile(std::string_view word)
{
    static constexpr std::string_view kExtensions[] = {
        ".csv", ".ele",  ".filamat", ".glb", ".gltf", ".jpeg", ".jpg", ".json", ".jsonl", ".ktx", ".mesh", ".mp4",
        ".msh", ".node", ".obj",     ".off", ".ply",  ".png",  ".rec", ".stl",  ".vtk",   ".vtp", ".vtu"};
    word = word.substr(0, word.find(':', 2)); // the line and column follow; a drive is one letter
    while (!word.empty() && std::string_view(":,;.()").find(word.back()) != std::string_view::npos)
        word.remove_suffix(1);
    if (word.find_first_of("/\\") != std::string_view::npos) return true;
    return std::ranges::any_of(kExtensions, [&](std::string_view each) { return word.ends_with(each); });
}

/// Behind the file that a line begins with ("my scans/liver 2.msh: is empty"), whose name may have spaces; 0 if it
/// begins with none.
std::size_t fileEnd(std::string_view line)
{
    const std::size_t end = line.find(": ");
    if (end == std::string_view::npos || line.substr(0, end).find('\'') != std::string_view::npos) return 0;
    for (std::string_view rest = line.substr(0, end); !rest.empty();) {
        const std::string_view word = rest.substr(0, rest.find(' '));
        if (isFile(word)) return end;
        rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    }
    return 0;
}

} // namespace

void setOwnNames(std::set<std::string> names) { ownNames() = std::move(names); }

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
    std::string out(line.substr(0, fileEnd(line)));
    line.remove_prefix(out.size());
    const auto take = [&](std::size_t count, bool rewrite) {
        out += rewrite ? snakeCase(line.substr(0, count)) : std::string(line.substr(0, count));
        line.remove_prefix(count);
    };
    while (!line.empty()) {
        const bool behindWord = !out.empty() && isPart(out.back());
        const std::size_t quoted = behindWord ? 0 : quotationEnd(line);
        const std::string_view token = line.substr(0, line.find(' '));
        const std::size_t word = static_cast<std::size_t>(std::ranges::find_if_not(line, isPart) - line.begin());
        if (quoted > 0)
            take(quoted, false);
        else if (!behindWord && isFile(token))
            take(token.size(), false);
        else if (word == 0)
            take(1, false);
        else
            take(word, isOwn(line.substr(0, word)));
    }
    return out;
}

} // namespace filasofia::python
