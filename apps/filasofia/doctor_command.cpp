#include "apps/filasofia/commands.h"
#include "apps/filasofia/doctor_report.h"
#include "filasofia/core/error.h"

#include <fstream>
#include <iostream>

namespace filasofia::app {
namespace {

struct DoctorOptions {
    std::string json; ///< the file to write; "-" for standard output instead of the table; empty for none
};

void writeJsonFile(const DoctorReport& report, const std::string& path)
{
    std::ofstream file(path);
    if (file) writeJson(report, file);
    file.close(); // writing the last bytes may fail too
    if (!file) fail("doctor: cannot write '", path, "'");
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

Command doctorCommand()
{
    static DoctorOptions options; // static: there is one command line, and its targets must outlive this function
    return {.name = "doctor",
            .meaning = "Report what this machine offers for the simulation, and what is missing",
            .options = {{.name = "--json",
                         .target = &options.json,
                         .meaning = "Write the report as JSON to FILE ('-' for standard output)",
                         .type = "FILE"}},
            .run = [] { return runDoctor(options); }};
}

} // namespace filasofia::app
