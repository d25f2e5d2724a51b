#include "filasofia/record/json_reader.h"

namespace filasofia::record {
namespace {

constexpr std::size_t kMaxShown = 40; // characters of a wrong value that an error shows

} // namespace

std::string Place::path() const
{
    if (name.empty()) return text(outer ? outer->path() : "", "[", index, "]");
    return outer ? text(outer->path(), ".", name) : std::string(name);
}

void Place::refuse(std::string_view must, const Json& got) const
{
    std::string shown = got.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (shown.size() > kMaxShown) shown.replace(kMaxShown, std::string::npos, "...");
    fail(path(), " ", must, ", got ", shown);
}

const Json& JsonReader::find(const Json& object, std::string_view name, const Place* outer)
{
    const auto found = object.find(std::string(name));
    if (found == object.end()) fail("field '", Place{outer, name}.path(), "' is missing");
    return *found;
}

void JsonReader::unknown(const std::string& name, const Place* outer)
{
    fail("unknown field '", name.substr(0, kMaxShown), "'", outer ? text(" in ", outer->path()) : "");
}

double JsonReader::number(const Json& json, const Place& place)
{
    if (json.is_number()) return json.get<double>();
    if (json == kInfinite) return std::numeric_limits<double>::infinity();
    if (json == kMinusInfinite) return -std::numeric_limits<double>::infinity();
    place.refuse("must be a number", json);
}

bool JsonReader::flag(const Json& json, const Place& place)
{
    if (!json.is_boolean()) place.refuse("must be true or false", json);
    return json.get<bool>();
}

std::string JsonReader::word(const Json& json, const Place& place)
{
    if (!json.is_string()) place.refuse("must be a text", json);
    return json.get<std::string>();
}

} // namespace filasofia::record
