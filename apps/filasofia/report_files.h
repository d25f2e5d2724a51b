#pragma once

#include <string_view>

/// Files embedded in the program by report/embed.cmake, for the page of a report.
namespace filasofia::app {

std::string_view pageStyle();
std::string_view pageScript();
// uPlot's files; empty if uPlot was missing when the program was configured.
std::string_view chartLibrary();
std::string_view chartStyle();
std::string_view chartLicence();

} // namespace filasofia::app
