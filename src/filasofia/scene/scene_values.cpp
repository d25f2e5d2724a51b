// What SceneReader makes of numbers, flags, words, rotations and boxes.
#include "filasofia/scene/quantity.h"
#include "filasofia/scene/scene_reader.h"

#include <cmath>

namespace filasofia::scene {
namespace {

/// A number that the field takes, and the same one with its unit, if it has one.
std::string exampleOf(const Bound& bound)
{
    constexpr double kCandidates[] = {0.01, 1.0, 100.0, -1.0, 0.0};
    const auto* taken = std::ranges::find_if(kCandidates, [&](double each) { return bound.range.contains(each); });
    const double value = taken == std::end(kCandidates) ? bound.range.low : *taken;
    const bool bare = bound.unit.empty() || bound.unit == "-";
    return bare ? text(value) : text(value, " or \"", value, " ", bound.unit, "\"");
}

} // namespace

double SceneReader::inUnit(const Json& json, const Place& place, const Bound& bound, double value,
                           std::string_view unit) const
{
    if (unit.empty()) return value;
    const auto scale = convert(unit, bound.unit);
    if (!scale) {
        if (unit.find(',') != std::string_view::npos)
            refuse(json, place, "must be written without commas, such as \"10.5 mm\" or \"0 10 0 mm\"");
        const bool bare = bound.unit.empty() || bound.unit == "-";
        const std::string must =
            bare ? "must be a number without a unit" : text("must be in ", bound.unit, " or a unit like it");
        const std::string near = nearestUnit(unit);
        refuse(json, place, must, near.empty() ? "" : text(" (did you mean '", near, "'?)"));
    }
    return value * scale->factor / scale->divisor;
}

double SceneReader::number(const Json& json, const Place& place, const Bound& bound) const
{
    double value = 0.0;
    if (json.is_number()) {
        value = json.get<double>();
    } else if (json.is_string()) {
        const std::string given = word(json);
        const auto quantity = parseQuantity(given);
        if (given == record::kInfinite || given == record::kMinusInfinite)
            value = (given == record::kInfinite ? 1.0 : -1.0) * std::numeric_limits<double>::infinity();
        else if (quantity && quantity->values.size() == 1)
            value = inUnit(json, place, bound, quantity->values[0], quantity->unit);
        else
            refuse(json, place, text("must be a number, such as ", exampleOf(bound)));
    } else {
        refuse(json, place, "must be a number");
    }
    if (!bound.range.contains(value)) refuse(json, place, bound.range.refusal(bound.unit, value));
    return value;
}

std::int64_t SceneReader::whole(const Json& json, const Place& place, const Bound& bound, double low, double high) const
{
    const double value = json.is_number() ? json.get<double>() : 0.5;
    const bool named = json.is_string() && place.name == "label"; // in a region
    if (value != std::floor(value))
        refuse(json, place, "must be a whole number", named ? " (the name of a label goes into the field 'name')" : "");
    if (value < low || value > high) refuse(json, place, text("must be in [", low, ", ", high, "]"));
    if (!bound.range.contains(value)) refuse(json, place, bound.range.text(bound.unit));
    return static_cast<std::int64_t>(value);
}

bool SceneReader::flag(const Json& json, const Place& place) const
{
    if (!json.is_boolean()) refuse(json, place, "must be true or false");
    return json.get<bool>();
}

std::string SceneReader::word(const Json& json) { return json.get<std::string>(); }
std::string SceneReader::word(const Json& json, const Place& place) const
{
    if (!json.is_string()) refuse(json, place, "must be a text");
    return word(json);
}

void SceneReader::readNumbers(const Json& json, const Place& place, const Bound& bound, std::span<double> out) const
{
    const auto refuseCount = [&] {
        const bool commas = json.is_string() && word(json).find(',') != std::string::npos;
        refuse(json, place,
               text("must be ", out.size(), " numbers", commas ? " without commas, such as \"0 10 0 mm\"" : ""));
    };
    if (json.is_array()) {
        if (json.size() != out.size()) refuseCount();
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = number(json[i], Place{&place, {}, i}, bound);
        return;
    }
    const std::string given = json.is_string() ? word(json) : std::string();
    const auto quantity = parseQuantity(given);
    if (!quantity || quantity->values.size() != out.size()) refuseCount();
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = inUnit(json, place, bound, quantity->values[i], quantity->unit);
        if (!bound.range.contains(out[i])) refuse(json, Place{&place, {}, i}, bound.range.refusal(bound.unit, out[i]));
    }
}

Quat SceneReader::rotation(const Json& json, const Place& place)
{
    Quat q;
    if (!json.is_object()) {
        readNumbers(json, place, {}, std::span(&q.w, 4));
        return q;
    }
    refuseUnknown(json, place, {"axis", "angle"});
    Vec3 axis;
    double angle = 0.0;
    for (const char* name : {"axis", "angle"})
        if (!find(json, name))
            refuse(json, place, text("must be 4 numbers (w, x, y, z), or have an axis and an angle"));
    read({{find(json, "axis")}}, Place{&place, "axis"}, {}, axis);
    read({{find(json, "angle")}}, Place{&place, "angle"}, {.unit = "rad"}, angle);
    if (!(length(axis) > 0.0)) refuse(*find(json, "axis"), Place{&place, "axis"}, "must have a length > 0");
    return axisAngle(axis, angle);
}

void SceneReader::readCorners(const Json& json, const Place& place, geometry::Box& out)
{
    if (json.size() != 2) refuse(json, place, "must be a lower and an upper corner");
    read({{&json[0]}}, Place{&place, {}, 0}, {.unit = "m"}, out.low);
    read({{&json[1]}}, Place{&place, {}, 1}, {.unit = "m"}, out.high);
    checkCorners(json, place, out);
}

void SceneReader::checkCorners(const Json& json, const Place& place, const geometry::Box& box) const
{
    if (geometry::isEmpty(box)) refuse(json, place, "must have a lower corner that is <= the upper one in every axis");
}

} // namespace filasofia::scene
