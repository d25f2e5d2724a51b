#include "apps/filasofia/build_info.h"
#include "apps/filasofia/doctor_report.h"
#include "filasofia/core/text.h"

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

namespace filasofia::app {
namespace {

/// The text after "key   :" in a /proc file; empty if there is no such key.
std::string procField(const char* path, std::string_view key)
{
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(':');
        if (!line.starts_with(key) || colon == std::string::npos) continue;
        const std::size_t start = line.find_first_not_of(" \t", colon + 1);
        return start == std::string::npos ? std::string() : line.substr(start);
    }
    return {};
}

/// A line of /proc/meminfo in GiB, rounded to a tenth.
Finding memory(std::string name, std::string_view key)
{
    const std::string kiB = procField("/proc/meminfo", key);
    if (kiB.empty()) return {.name = std::move(name), .value = "unknown"};
    const double GiB = std::round(std::strtod(kiB.c_str(), nullptr) / (1024.0 * 1024.0) * 10.0) / 10.0;
    return {.name = std::move(name),
            .value = GiB,
            .unit = "GiB",
            .hint = GiB < 1.0 ? "less than 1 GiB: close other programs" : ""};
}

std::string vectorInstructions()
{
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f")) return "AVX-512";
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "AVX2 + FMA";
    if (__builtin_cpu_supports("avx")) return "AVX";
    if (__builtin_cpu_supports("sse4.2")) return "SSE4.2";
    return "SSE2";
#elif defined(__aarch64__)
    return "NEON";
#else
    return "unknown to this program";
#endif
}

long long usableCores()
{
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return CPU_COUNT(&allowed);
    return sysconf(_SC_NPROCESSORS_ONLN);
}

std::string operatingSystem()
{
    utsname name = {};
    if (uname(&name) != 0) return "unknown";
    return text(name.sysname, " ", name.release, " ", name.machine);
}

Finding library(std::string name, std::string_view version)
{
    if (version.empty()) return {.name = std::move(name), .value = "not built in"};
    return {.name = std::move(name), .value = std::string(version)};
}

} // namespace

Section examineProgram()
{
    Finding buildType = {.name = "build type", .value = kBuildType};
    if (std::string_view(kBuildType) != "Release")
        buildType.hint = "for full speed configure with -DCMAKE_BUILD_TYPE=Release";
    Section section = {.title = "program",
                       .findings = {{.name = "version", .value = kVersion},
                                    {.name = "git revision", .value = kGitRevision},
                                    {.name = "compiler", .value = kCompiler},
                                    buildType}};
    if (*kSanitizers) section.findings.push_back({.name = "sanitizers", .value = kSanitizers});
    return section;
}

Section examineProcessor()
{
    std::string model = procField("/proc/cpuinfo", "model name");
    const long long cores = usableCores();
    return {.title = "machine",
            .findings = {
                {.name = "system", .value = operatingSystem()},
                {.name = "processor", .value = model.empty() ? "unknown" : std::move(model)},
                {.name = "cores",
                 .value = cores,
                 .hint = cores < 4 ? "physics, drawing and a haptic device each need a core: use 4 cores or more" : ""},
                {.name = "vector instructions", .value = vectorInstructions()},
                memory("memory", "MemTotal"),
                memory("memory available", "MemAvailable"),
            }};
}

Section examineLibraries()
{
    return {.title = "libraries",
            .findings = {library("Filament", kFilamentVersion), library("SDL", kSdlVersion),
                         library("Eigen", kEigenVersion), library("assimp", kAssimpVersion),
                         library("OpenSubdiv", kOpenSubdivVersion)}};
}

} // namespace filasofia::app
