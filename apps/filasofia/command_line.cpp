#include "apps/filasofia/command_line.h"

#include "apps/filasofia/build_info.h"
#include "apps/filasofia/suggestion.h"
#include "filasofia/core/error.h"

// Long to compile: included here only.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

namespace filasofia::app {
namespace {

int refuse(std::string line, int code)
{
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "filasofia: " << line << '\n';
    return code;
}

/// Teaches CLI11 one option. The words of the user's that are no legal choice are refused with the nearest one.
void addOption(CLI::App& app, const Option& option)
{
    CLI::Option* added = std::visit(
        [&](auto* target) -> CLI::Option* {
            if constexpr (std::is_same_v<decltype(target), bool*>)
                return app.add_flag(option.name, *target, option.meaning);
            else
                return app.add_option(option.name, *target, option.meaning);
        },
        option.target);
    added->required(option.required);
    if (!option.type.empty()) added->type_name(option.type);
    if (std::holds_alternative<std::string*>(option.target))
        added->check([](const std::string& word) { return word.empty() ? std::string("must not be empty") : ""; });
    if (option.choices.empty()) return;
    added->check([choices = option.choices](const std::string& word) {
        if (std::find(choices.begin(), choices.end(), word) != choices.end()) return std::string();
        const std::string hint = didYouMean(word, choices);
        if (!hint.empty()) return text("unknown word '", word, "'", hint);
        std::string list;
        for (const std::string& choice : choices) list += text(list.empty() ? "" : ", ", choice);
        return text("unknown word '", word, "' (known: ", list, ")");
    });
}

std::vector<std::string> optionNames(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// The first word that nobody understood, as an error; empty when all were understood. `after` is "" or " after 'run'".
std::string unknownWord(const CLI::App& app, const std::string& after, const std::vector<std::string>& commands)
{
    for (const std::string& word : app.remaining()) {
        if (word == "--") continue;
        if (word.starts_with('-')) {
            const std::string name = word.substr(0, word.find('='));
            return text("unknown option '", word, "'", after, didYouMean(name, optionNames(app)));
        }
        if (after.empty() && app.get_subcommands().empty())
            return text("unknown command '", word, "'", didYouMean(word, commands));
        return text("unexpected word '", word, "'", after);
    }
    for (const CLI::App* chosen : app.get_subcommands()) {
        std::string found = unknownWord(*chosen, text(" after '", chosen->get_name(), "'"), {});
        if (!found.empty()) return found;
    }
    return {};
}

int understandAndRun(int argc, char** argv, const std::vector<Command>& commands)
{
    CLI::App app("Real-time surgical simulation: soft tissue, haptic rates, an endoscope's picture.", "filasofia");
    app.set_version_flag("--version", std::string("filasofia ") + kVersion);
    app.require_subcommand(0, 1);
    app.allow_extras(); // unknown words are kept, so that we can name them ourselves
    std::vector<std::string> names;
    for (const Command& command : commands) {
        CLI::App* words = app.add_subcommand(command.name, command.meaning);
        for (const Option& option : command.options) addOption(*words, option);
        names.push_back(command.name);
    }

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) { // --help, --version
        return app.exit(asked);
    } catch (const CLI::ParseError& error) {
        // A missing word is often a misspelt one: the misspelling says more.
        const std::string unknown = unknownWord(app, "", names);
        return refuse(unknown.empty() ? error.what() : unknown, kRefused);
    }
    if (const std::string unknown = unknownWord(app, "", names); !unknown.empty()) return refuse(unknown, kRefused);
    for (const Command& command : commands)
        if (app.got_subcommand(command.name)) return command.run();
    std::cerr << app.help();
    return kRefused;
}

} // namespace

int runCommandLine(int argc, char** argv, const std::vector<Command>& commands)
{
    try {
        const int code = understandAndRun(argc, argv, commands);
        // A full disk or a closed pipe shows only when the last bytes leave.
        if (!std::cout.flush()) return refuse("cannot write to standard output", kFailed);
        return code;
    } catch (const Error& error) {
        return refuse(error.what(), kRefused);
    } catch (const std::exception& error) {
        return refuse(text("internal error: ", error.what()), kFailed);
    }
}

} // namespace filasofia::app
