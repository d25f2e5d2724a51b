#include "apps/filasofia/commands.h"
#include "filasofia/core/error.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace filasofia::app {
namespace {

// Images are read and meshed in Python, with NumPy. Without the package one line says so, not Python's own traces, and
// who asks for help gets it in any case.
constexpr const char* kProgram =
    "import sys\n"
    "help = sys.argv.pop(1)\n"
    "try:\n"
    "    from filasofia.anatomy.__main__ import main\n"
    "except ImportError as problem:\n"
    "    if {'-h', '--help'} & set(sys.argv): sys.exit(print(help))\n"
    "    sys.exit(print('filasofia:', sys.argv[1], 'needs the Python package filasofia: pip install "
    "\"filasofia[anatomy]\", or FILASOFIA_PYTHON names the Python that has it (' + str(problem) + ')', "
    "file=sys.stderr) or 2)\n"
    "sys.exit(main(sys.argv[1:]))\n";

constexpr const char* kMeshHelp =
    "filasofia mesh INPUT... -o FILE.msh: tetrahedra of a label map, of surfaces or of another mesh\n"
    "  filasofia mesh patient.nii.gz -o patient.msh --parts organs\n"
    "  filasofia mesh liver.stl -o liver.msh --scale 0.001 --size 4mm\n"
    "All options: docs/guide/patient.md, or this command with the Python package filasofia "
    "(pip install \"filasofia[anatomy]\", or FILASOFIA_PYTHON names the Python that has it).";
constexpr const char* kSceneHelp =
    "filasofia scene new INPUT... [-o FILE.json]: a scene file that runs\n"
    "  filasofia scene new patient.nii.gz\n"
    "All options: docs/guide/patient.md, or this command with the Python package filasofia "
    "(pip install \"filasofia[anatomy]\", or FILASOFIA_PYTHON names the Python that has it).";

Command handedOver(const char* name, const char* meaning)
{
    return {.name = name, .meaning = meaning, .run = []() -> int { fail("this command runs in Python"); }};
}

} // namespace

bool isForPython(int argc, char** argv)
{
    return argc > 1 && (std::string_view(argv[1]) == "mesh" || std::string_view(argv[1]) == "scene");
}

void handOverToPython(int argc, char** argv)
{
    const char* given = std::getenv("FILASOFIA_PYTHON");
    const std::string python = given && *given ? given : "python3";
    const char* help = std::string_view(argv[1]) == "mesh" ? kMeshHelp : kSceneHelp;
    std::vector<char*> words = {const_cast<char*>(python.c_str()), const_cast<char*>("-c"), const_cast<char*>(kProgram),
                                const_cast<char*>(help)};
    words.insert(words.end(), argv + 1, argv + argc);
    words.push_back(nullptr);
    execvp(python.c_str(), words.data());
    if (std::any_of(argv + 2, argv + argc, [](std::string_view word) { return word == "-h" || word == "--help"; })) {
        std::puts(help);
        std::exit(0);
    }
    fail(argv[1], ": runs in Python, and '", python, "' cannot be started (FILASOFIA_PYTHON names another one)");
}

Command meshCommand()
{
    return handedOver("mesh", "Make tetrahedra of a label map, of surfaces or of another mesh (in Python)");
}

Command sceneCommand()
{
    return handedOver("scene", "Make a scene file that runs: filasofia scene new patient.nii.gz (in Python)");
}

} // namespace filasofia::app
