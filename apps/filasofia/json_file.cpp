#include "apps/filasofia/json_file.h"

#include "filasofia/core/error.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace filasofia::app {

JsonFile::JsonFile(const std::string& name) : name_(name)
{
    if (name_.empty()) return;
    if (name_ == "-") fail("--json -: standard output carries the table; name a file");
    file_.open(name_);
    if (!file_) fail(name_, ": cannot be written");
}

void JsonFile::write(const nlohmann::json& figures)
{
    if (name_.empty()) return;
    using nlohmann::json;
    file_ << figures.dump(-1, ' ', false, json::error_handler_t::replace) << '\n'; // a driver's text may hold any bytes
    file_.close(); // writing the last bytes may fail too
    if (!file_) fail(name_, ": cannot be written (disk full?)");
    std::printf("wrote %s\n", name_.c_str());
}

} // namespace filasofia::app
