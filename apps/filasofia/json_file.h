#pragma once

#include <nlohmann/json_fwd.hpp>

#include <fstream>
#include <string>

namespace filasofia::app {

/// The file of a command that measures for minutes: opened before them, so that a name that cannot be written is told
/// at once.
class JsonFile {
public:
    /// Nothing is written where the name is empty. An Error where it cannot be opened, and for "-": the table is there.
    explicit JsonFile(const std::string& name);
    /// All of it, or an Error.
    void write(const nlohmann::json& figures);

private:
    std::string name_;
    std::ofstream file_;
};

} // namespace filasofia::app
