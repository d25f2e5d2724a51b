#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"

int main(int argc, char** argv)
{
    using namespace filasofia::app;
    return runCommandLine(argc, argv,
                          {runCommand(), replayCommand(), reportCommand(), filmCommand(), benchCommand(), fuzzCommand(),
                           tissuesCommand(), meshCommand(), sceneCommand(), saveCommand(), schemaCommand(),
                           doctorCommand()});
}
