#include "apps/filasofia/commands.h"
#include "apps/filasofia/doctor_report.h"
#include "filasofia/core/error.h"

#include <CLI/CLI.hpp>

#include <fstream>
#include <iostream>

namespace filasofia::app {
namespace {

struct DoctorOptions {
    std::string json; ///< the file to write, "-" for standard output in place of the table, empty for none
};

void writeJsonFile(const DoctorReport& report, const std::string& path)
{
    std::ofstream file(path);
    if (file) writeJson(report, file);
    if (!file.flush()) fail("doctor: cannot write '", path, "'");
}

int runDoctor(const DoctorOptions& options)
{
    const DoctorReport report = {examineProgram(), examineProcessor(),  examineGpu(),   examineDisplay(),
                                 examineDevices(), examineScheduling(), examineTimer(), examineLibraries()};
    if (options.json == "-") {
        writeJson(report, std::cout);
        return 0;
    }
    if (!options.json.empty()) writeJsonFile(report, options.json);
    writeTable(report, std::cout);
    return 0;
}

} // namespace

void addDoctor(CLI::App& app, Action& chosen)
{
    static DoctorOptions options; // there is one command line, and it outlives this function
    CLI::App* words =
        app.add_subcommand("doctor", "Say what this machine can do for the simulation, and what is missing");
    words->add_option("--json", options.json, "Write the report as JSON to FILE ('-': to standard output)")
        ->type_name("FILE");
    words->callback([&chosen] { chosen = [] { return runDoctor(options); }; });
}

} // namespace filasofia::app
