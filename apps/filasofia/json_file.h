#pragma once

#include <nlohmann/json_fwd.hpp>

#include <fstream>
#include <string>

namespace filasofia::app {

/// The output file of a command that measures for minutes. It is opened beforehand, so that a name that cannot be
/// written is reported at once.
class JsonFile {
public:
    /// If the name is empty, nothing is written. Throws Error if the file cannot be opened, and for "-", as standard
    /// output carries the table.
    explicit JsonFile(const std::string& name);
    /// Writes all figures, or throws Error.
    void write(const nlohmann::json& figures);

private:
    std::string name_;
    std::ofstream file_;
};

} // namespace filasofia::app
