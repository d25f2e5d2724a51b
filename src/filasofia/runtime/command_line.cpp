#include "filasofia/runtime/simulation.h"

#include "filasofia/core/word.h"
#include "filasofia/runtime/engines.h"
#include "filasofia/runtime/keys.h"
#include "filasofia/runtime/options.h"

#include <CLI/CLI.hpp>

#include <iostream>

namespace filasofia::runtime {
namespace {

constexpr int kIncomplete = 1; ///< exit code: the run reached its end, but a script or one of its files did not
constexpr int kRefused = 2;    ///< exit code: the user's words or files were wrong
constexpr int kHeadlessSteps = 1000;

/// Adds an option that sets a field of the RunDef. CLI11 passes on the words unchanged, so that errors are in our own
/// form.
template <class Value>
void addOption(CLI::App& app, const std::string& name, Value RunDef::*member, RunDef& def, const std::string& meaning)
{
    const auto take = [&def, member, name = "run: " + name](const std::string& word) {
        Value& target = def.*member;
        if constexpr (std::is_same_v<Value, int>)
            target = wholeNumber(name, word, boundOf(member));
        else if constexpr (std::is_same_v<Value, double>)
            target = realNumber(name, word, boundOf(member));
        else if (word.empty())
            fail(name, " must not be empty");
        else
            target = word;
    };
    CLI::Option* added = app.add_option_function<std::string>(name, take, meaning);
    if constexpr (std::is_same_v<Value, std::string>)
        added->type_name(name == "--session" || name == "--trainee" || name == "--device" ? "NAME" : "FILE")
            ->default_str("none");
    else
        added->type_name("N")->default_str(text(def.*member));
}

/// "native or sofa".
std::string listedEngines()
{
    std::string all;
    for (const std::string& name : engineNames()) all += (all.empty() ? "" : " or ") + name;
    return all;
}

} // namespace

int Simulation::run(int argc, const char* const* argv)
{
    return runtime::run(*this, std::vector<std::string>(argv, argv + argc));
}

int run(Simulation& simulation, const std::vector<std::string>& words, const std::vector<OwnOption>& own)
{
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    RunDef def;
    CLI::App app("A Filasofia simulation");
    if (own.empty())
        app.footer("Mouse and keys in the window:\n" +
                   keyHelp()); // a program with options of its own prints its own help
    app.add_flag("--headless", def.headless, "a plain loop without window or clock; every run gives the same result");
    bool blind = false;
    app.add_flag("--no-picture", blind,
                 "a live run without window or pictures: physics on its own thread, paced by the clock");
    std::string engine;
    app.add_option("--engine", engine, "physics engine: " + listedEngines())
        ->type_name("NAME")
        ->default_str("the program's");
    addOption(app, "--steps", &RunDef::steps, def,
              text("end after this many steps; 0: no limit (headless: ", kHeadlessSteps, ")"));
    addOption(app, "--seconds", &RunDef::seconds, def, "end after this many seconds of wall time; 0: no limit");
    addOption(app, "--picture", &RunDef::picture, def, "write the last state to this PNG file");
    addOption(app, "--picture-every", &RunDef::pictureEvery, def,
              "with --headless: write numbered pictures, this many seconds apart; 0: only the last");
    addOption(app, "--video", &RunDef::video, def,
              "write the pictures to this file: .avi, or .mp4 (needs the program ffmpeg)");
    addOption(app, "--fps", &RunDef::fps, def, "pictures per second of the video");
    addOption(app, "--log", &RunDef::log, def, "write a line per step to this CSV file");
    addOption(app, "--record", &RunDef::record, def, "write the run to this .rec file, for 'filasofia replay'");
    addOption(app, "--seed", &RunDef::seed, def, "seed of the program's random numbers, stored in the recording");
    addOption(app, "--session", &RunDef::session, def, "name of the session, stored in the recording");
    addOption(app, "--trainee", &RunDef::trainee, def, "name of the trainee, stored in the recording");
    addOption(app, "--device", &RunDef::device, def,
              "devices of the first haptic interfaces: NAME or NAME:LIBRARY, a driver and its vendor's library, ...");
    addOption(app, "--motion", &RunDef::motion, def,
              "play this motion file in place of a device, or several: FILE,FILE");
    addOption(app, "--record-motion", &RunDef::recordMotion, def, "record the hand's motion in this motion file");
    for (const OwnOption& option : own)
        if (CLI::Option* same = app.get_option_no_throw(option.name)) same->group(""); // not in the help
    try {
        app.parse(static_cast<int>(arguments.size()), arguments.data());
        if (app.count("--fps") > 0 && def.video.empty()) fail("run: --fps needs --video FILE");
        if (blind) def.backend = visual::Backend::Null;
        if (blind && !(def.picture.empty() && def.video.empty()))
            fail("run: --no-picture cannot be combined with --picture or --video");
        const bool endless = def.headless && def.steps == 0; // a headless run has no window that a user could close
        if (endless) def.steps = kHeadlessSteps;
        if (app.count("--engine") > 0) simulation.useEngine(engine);
        RunReport report = simulation.run(def);
        if (blind) report.visual.framesDrawn = 0; // the Null backend counts pictures although it draws nothing
        std::cout << summary(report);
        if (endless && report.steps == kHeadlessSteps)
            std::cout << "a headless run without --steps ends after " << kHeadlessSteps << " steps\n";
        if (!std::cout.flush()) fail("cannot write to standard output");
        return report.complete() ? 0 : kIncomplete;
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return 0;
    } catch (const CLI::ArgumentMismatch& problem) {
        const std::string said = problem.what();
        return report(Error(text(said.substr(0, said.find(':')), " must be given once, with one value")));
    } catch (const CLI::ExtrasError&) {
        return report(
            Error(text("unknown word '", shortened(app.remaining().front()), "'; --help lists the known ones")));
    } catch (const CLI::ParseError& problem) {
        return report(Error(problem.what()));
    } catch (const Error& problem) {
        return report(problem);
    } catch (const std::exception& problem) { // thrown by the user's dress() or window
        return report(Error(text("an exception ended the run: ", problem.what())));
    } catch (...) {
        return report(Error("an exception ended the run: it is not a std::exception"));
    }
}

int report(const Error& error)
{
    std::cerr << withShortWords(error.what()) << '\n';
    return kRefused;
}

} // namespace filasofia::runtime
