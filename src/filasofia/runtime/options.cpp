#include "filasofia/runtime/options.h"

#include "filasofia/core/text.h"
#include "filasofia/core/word.h"

#include <algorithm>
#include <string_view>

namespace filasofia::runtime {
namespace {

/// "small, medium or lobed", or "small, medium, lobed or a .json file".
std::string choicesOf(const OwnOption& option)
{
    std::vector<std::string> words = option.choices;
    if (!option.fileType.empty()) words.push_back(text("a ", option.fileType, " file"));
    std::string all;
    for (std::size_t i = 0; i < words.size(); ++i)
        all += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    return all;
}

} // namespace

std::vector<std::string> takeOptions(const std::string& program, int argc, const char* const* argv,
                                     const std::vector<OwnOption>& options)
{
    std::vector<std::string> rest;
    std::vector<const OwnOption*> given;
    for (int i = 0; i < argc; ++i) {
        const std::string_view word = argv[i];
        const std::size_t equals = word.find('=');
        const auto found = std::ranges::find(options, word.substr(0, equals), &OwnOption::name);
        if (i == 0 || found == options.end()) {
            rest.emplace_back(word);
            continue;
        }
        if (std::ranges::find(given, &*found) != given.end())
            fail(program, ": ", found->name, " must be given once, with one value");
        given.push_back(&*found);
        const bool next = equals == std::string_view::npos; // the value is the next word, which must not be an option
        if (next && (++i == argc || std::string_view(argv[i]).starts_with("--")))
            fail(program, ": ", found->name, " needs a value");
        const std::string value(next ? std::string_view(argv[i]) : word.substr(equals + 1));
        const bool isFile = !found->fileType.empty() && value.ends_with(found->fileType);
        if (!found->choices.empty() && !isFile && std::ranges::find(found->choices, value) == found->choices.end())
            fail(program, ": ", found->name, " must be ", choicesOf(*found), ", got ", shownWord(value));
        *found->value = value;
    }
    return rest;
}

std::string optionHelp(const std::vector<OwnOption>& options)
{
    const auto nameOf = [](const OwnOption& option) {
        return "  " + option.name + " " + (option.choices.empty() ? "WORD" : choicesOf(option)) + "  ";
    };
    std::size_t widest = 0;
    for (const OwnOption& option : options) widest = std::max(widest, nameOf(option).size());
    std::string help;
    for (const OwnOption& option : options) {
        std::string name = nameOf(option);
        name.resize(widest, ' ');
        help += name + option.meaning + (option.value->empty() ? "" : " (" + *option.value + ")") + "\n";
    }
    return help;
}

} // namespace filasofia::runtime
