#include "apps/filasofia/command_line.h"

#include "apps/filasofia/build_info.h"
#include "apps/filasofia/suggestion.h"
#include "filasofia/core/error.h"

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

std::vector<std::string> optionNames(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

std::vector<std::string> commandNames(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

/// The first word that nobody understood, as an error; empty when all were understood.
std::string unknownWord(const CLI::App& app)
{
    for (const std::string& word : app.remaining(false)) {
        if (word == "--") continue;
        const std::string name = word.substr(0, word.find('='));
        if (word.front() == '-') return text("unknown option '", word, "'", didYouMean(name, optionNames(app)));
        if (app.get_subcommands().empty())
            return text("unknown command '", word, "'", didYouMean(word, commandNames(app)));
        return text("unexpected word '", word, "'");
    }
    for (const CLI::App* command : app.get_subcommands()) {
        for (const std::string& word : command->remaining(false)) {
            const std::string name = word.substr(0, word.find('='));
            const std::string where = text(" after '", command->get_name(), "'");
            if (word == "--") continue;
            if (word.front() == '-')
                return text("unknown option '", word, "'", where, didYouMean(name, optionNames(*command)));
            return text("unexpected word '", word, "'", where);
        }
    }
    return {};
}

int understandAndRun(int argc, char** argv, std::initializer_list<AddCommand> commands)
{
    CLI::App app("Real-time surgical simulation: soft tissue, haptic rates, an endoscope's picture.", "filasofia");
    app.set_version_flag("--version", std::string("filasofia ") + kVersion);
    app.allow_extras(); // unknown words are kept, so that we can name them ourselves
    Action chosen;
    for (const AddCommand add : commands) add(app, chosen);
    app.require_subcommand(0, 1);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) { // --help, --version
        return app.exit(asked);
    } catch (const CLI::ParseError& error) {
        // A missing word is often a misspelt one: the misspelling says more.
        const std::string unknown = unknownWord(app);
        return refuse(unknown.empty() ? error.what() : unknown, kRefused);
    }
    if (const std::string unknown = unknownWord(app); !unknown.empty()) return refuse(unknown, kRefused);
    if (!chosen) {
        std::cerr << app.help();
        return kRefused;
    }
    return chosen();
}

} // namespace

int runCommandLine(int argc, char** argv, std::initializer_list<AddCommand> commands)
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
