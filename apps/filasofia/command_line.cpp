#include "apps/filasofia/command_line.h"

#include "apps/filasofia/build_info.h"
#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"

// Slow to compile, so it is included only here.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

namespace filasofia::app {
namespace {

int refuse(std::string line, int code)
{
    std::cerr << "filasofia: " << withShortWords(oneLine(std::move(line))) << '\n';
    return code;
}

/// Writes the word that the user gave to an option's target. Errors call the option `name`.
void take(const Option& option, const std::string& name, const std::string& word)
{
    const std::vector<std::string>& choices = option.choices;
    if (!choices.empty() && std::find(choices.begin(), choices.end(), word) == choices.end()) {
        std::string list;
        for (const std::string& choice : choices) list += text(list.empty() ? "" : ", ", choice);
        fail(name, " must be one of ", list, ", got ", shownWord(word));
    }
    if (auto* const* whole = std::get_if<int*>(&option.target))
        **whole = wholeNumber(name, word, option.bound);
    else if (auto* const* real = std::get_if<double*>(&option.target))
        **real = realNumber(name, word, option.bound);
    else if (word.empty())
        fail(name, " must not be empty");
    else
        *std::get<std::string*>(option.target) = word;
}

/// A target's value before any option is given, as the help shows it.
std::string standardOf(const Option& option)
{
    if (!option.standard.empty()) return option.standard;
    if (auto* const* whole = std::get_if<int*>(&option.target)) return text(**whole);
    if (auto* const* real = std::get_if<double*>(&option.target)) return text(**real);
    const std::string& words = *std::get<std::string*>(option.target);
    return words.empty() ? "none" : words;
}

/// Registers one option with CLI11. CLI11 hands over the words unchanged, so that all error texts are our own.
void addOption(CLI::App& app, const Option& option)
{
    if (bool* const* flag = std::get_if<bool*>(&option.target)) {
        app.add_flag(option.name, **flag, option.meaning);
        return;
    }
    const auto takeWord = [option, name = text(app.get_name(), ": ", option.name)](const std::string& word) {
        take(option, name, word);
    };
    CLI::Option* added = app.add_option_function<std::string>(option.name, takeWord, option.meaning);
    added->required(option.required);
    const char* type = std::holds_alternative<std::string*>(option.target) ? "TEXT" : "N";
    added->type_name(option.type.empty() ? type : option.type);
    if (!option.required) added->default_str(standardOf(option));
}

std::vector<std::string> optionNames(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// The first unknown word, as an error text; empty if all words are known. `after` is "" or " after 'run'".
std::string unknownWord(const CLI::App& app, const std::string& after, const std::vector<std::string>& commands)
{
    for (const std::string& word : app.remaining()) {
        if (word == "--") continue;
        if (word.starts_with('-')) {
            const std::string name = word.substr(0, word.find('='));
            return text("unknown option '", shortened(word), "'", after, didYouMean(name, optionNames(app)));
        }
        if (after.empty() && app.get_subcommands().empty())
            return text("unknown command '", shortened(word), "'", didYouMean(word, commands));
        return text("unexpected word '", shortened(word), "'", after);
    }
    for (const CLI::App* chosen : app.get_subcommands()) {
        std::string found = unknownWord(*chosen, text(" after '", chosen->get_name(), "'"), {});
        if (!found.empty()) return found;
    }
    return {};
}

/// The error in our own words.
std::string inOurWords(const CLI::ParseError& error)
{
    const std::string said = error.what();
    if (!dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return said;
    return text(said.substr(0, said.find(':')), " must be given once, with one value");
}

int understandAndRun(int argc, char** argv, const std::vector<Command>& commands)
{
    CLI::App app("Real-time surgical simulation: soft tissue, haptics and an endoscope's view.", "filasofia");
    app.set_version_flag("--version", std::string("filasofia ") + kVersion);
    app.require_subcommand(0, 1);
    app.allow_extras(); // keeps unknown words, so that our own errors can name them
    std::vector<std::string> names;
    for (const Command& command : commands) {
        CLI::App* words = app.add_subcommand(command.name, command.meaning);
        words->footer(command.footer);
        for (const Option& option : command.options) addOption(*words, option);
        names.push_back(command.name);
    }

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) { // --help, --version
        return app.exit(asked);
    } catch (const CLI::ParseError& error) {
        // A missing word is often a misspelt one. If so, the misspelling is the better error.
        const std::string unknown = unknownWord(app, "", names);
        return refuse(unknown.empty() ? inOurWords(error) : unknown, kRefused);
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
        if (isForPython(argc, argv)) handOverToPython(argc, argv);
        const int code = understandAndRun(argc, argv, commands);
        // A full disk or a closed pipe shows only when the last bytes are written.
        if (!std::cout.flush()) return refuse("cannot write to standard output", kFailed);
        return code;
    } catch (const Error& error) {
        return refuse(error.what(), kRefused);
    } catch (const std::exception& error) {
        return refuse(text("internal error: ", error.what()), kFailed);
    }
}

} // namespace filasofia::app
