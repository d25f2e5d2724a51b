#include "filasofia/scene/def_shapes.h"
#include "filasofia/scene/scene_file.h"

#include "filasofia/physics/tissue.h"

#include <algorithm>
#include <cmath>

namespace filasofia::scene {
namespace {

using Schema = nlohmann::ordered_json; ///< keeps the order of the fields

Schema reference(std::string_view type) { return {{"$ref", text("#/$defs/", type)}}; }

/// The bounds of a number that is written without a unit.
void addBounds(const Range& range, Schema& to)
{
    if (std::isfinite(range.low)) to[range.lowOpen ? "exclusiveMinimum" : "minimum"] = range.low;
    if (std::isfinite(range.high)) to[range.highOpen ? "exclusiveMaximum" : "maximum"] = range.high;
}

/// The schema of a type's values, with the bounds and the unit of their field.
template <class T> struct ValueSchema {
    static Schema of(const Range& range)
    {
        if constexpr (std::is_same_v<T, double>)
            return number(range);
        else if constexpr (std::is_same_v<T, bool>)
            return {{"type", "boolean"}};
        else if constexpr (std::is_integral_v<T>)
            return whole(range);
        else if constexpr (std::is_same_v<T, std::string> || IsFile<T>)
            return {{"type", "string"}};
        else if constexpr (std::is_same_v<T, BodyId>)
            return {{"type", "string"}, {"description", "name of a body before this one"}};
        else if constexpr (std::is_same_v<T, AttachmentId>)
            return {{"type", "string"}, {"description", "name of an attachment"}};
        else if constexpr (std::is_enum_v<T>)
            return {{"enum", names(static_cast<const T*>(nullptr))}};
        else if constexpr (IsMesh<T>)
            return anyOf({{{"type", "string"}}, ValueSchema<typename MeshShapes<T>::Shapes>::typed()});
        else if constexpr (std::is_same_v<T, Vec3>)
            return numbers(range, 3);
        else if constexpr (std::is_same_v<T, Quat>)
            return anyOf({numbers(range, 4), axisAndAngle()});
        else if constexpr (std::is_same_v<T, Pose>)
            return anyOf({reference("Pose"), numbers(range, 3)});
        else if constexpr (std::is_same_v<T, visual::Color>)
            return anyOf({numbers(closed(0, 1), 3), reference("Color")});
        else if constexpr (std::is_same_v<T, geometry::Box>)
            return anyOf({{{"type", "array"}, {"items", numbers(range, 3)}, {"minItems", 2}, {"maxItems", 2}},
                          reference("Box")});
        else
            return reference(typeName<T>());
    }
    static Schema number(const Range& range)
    {
        Schema out = {{"type", {"number", "string"}}};
        addBounds(range, out);
        return out;
    }
    static Schema whole(const Range& range)
    {
        Schema out = {{"type", "integer"}};
        addBounds(range, out);
        return out;
    }
    static Schema numbers(const Range& range, std::size_t count)
    {
        const Schema list = {{"type", "array"}, {"items", number(range)}, {"minItems", count}, {"maxItems", count}};
        return anyOf({list, {{"type", "string"}}});
    }
    static Schema axisAndAngle()
    {
        return {{"type", "object"},
                {"properties", {{"axis", numbers(finite(), 3)}, {"angle", number(finite())}}},
                {"required", {"axis", "angle"}},
                {"additionalProperties", false}};
    }
    static Schema anyOf(const std::vector<Schema>& each) { return {{"anyOf", each}}; }
};
template <class T> struct ValueSchema<std::optional<T>> {
    static Schema of(const Range& range) { return {{"anyOf", {ValueSchema<T>::of(range), {{"type", "null"}}}}}; }
};
template <class T> struct ValueSchema<std::vector<T>> {
    static Schema of(const Range& range) { return {{"type", "array"}, {"items", ValueSchema<T>::of(range)}}; }
};
template <class T, std::size_t n> struct ValueSchema<std::array<T, n>> {
    static Schema of(const Range& range)
    {
        if constexpr (std::is_same_v<T, double>)
            return ValueSchema<double>::numbers(range, n);
        else
            return {{"type", "array"}, {"items", ValueSchema<T>::of(range)}, {"minItems", n}, {"maxItems", n}};
    }
};
template <class... Each>
requires(!IsMesh<std::variant<Each...>> && !IsFile<std::variant<Each...>>) struct ValueSchema<std::variant<Each...>> {
    /// The first alternative needs no type: it is the one that fields have by default.
    static Schema of(const Range& range)
    {
        Schema out = Schema::array();
        Schema words = Schema::array();
        const auto add = [&]<class T>() {
            if constexpr (HasFields<T> && !std::is_same_v<T, Vec3>) {
                out.push_back(out.empty() ? reference(typeName<T>()) : withType<T>());
                words.push_back(typeName<T>());
            } else if constexpr (!std::is_same_v<T, Vec3>) {
                out.push_back(ValueSchema<T>::of(range));
            }
        };
        (add.template operator()<Each>(), ...);
        out.push_back({{"enum", words}});
        return {{"anyOf", out}};
    }
    static Schema typed() { return {{"anyOf", {withType<Each>()...}}}; }

private:
    template <class T> static Schema withType()
    {
        return {{"allOf", {reference(typeName<T>())}}, {"required", {"type"}}};
    }
};

/// A field with its meaning and unit.
template <class Value> Schema fieldSchema(const auto& field)
{
    Schema out = ValueSchema<Value>::of(field.range);
    const bool bare = field.unit.empty() || field.unit == "-";
    out["description"] = bare ? std::string(field.meaning) : text(field.meaning, " [", field.unit, "]");
    return out;
}

template <HasFields T> Schema properties()
{
    Schema out = {{"type", {{"const", typeName<T>()}}}, {"class", {{"type", "string"}}}};
    if constexpr (std::is_same_v<T, physics::FemMaterial>) {
        Schema known = Schema::array();
        for (const physics::Tissue& each : physics::tissues()) known.push_back(each.name);
        out["tissue"] = {{"enum", known},
                         {"description", "a tissue of the library, with whose constants and density it begins"}};
    }
    forEachField<T>([&](const auto& each) {
        using Value = std::remove_cvref_t<decltype(std::declval<T&>().*(each.member))>;
        if (!each.name.empty()) out[std::string(each.name)] = fieldSchema<Value>(each);
    });
    return out;
}

Schema objectOf(Schema members)
{
    return {{"type", "object"}, {"properties", std::move(members)}, {"additionalProperties", false}};
}

/// An object of a Def; a default for it may lack what it must have.
template <HasFields T> Schema wholeObject()
{
    Schema out = objectOf(properties<T>());
    if (const auto names = required<T>(); !names.empty()) out["required"] = names;
    return out;
}

/// An object with the fields of one of several Defs beside its own.
template <class Flat, class... Each> Schema flatSchema(const std::variant<Each...>*)
{
    const auto one = []<class T>() {
        Schema members = properties<Flat>();
        members.update(properties<T>());
        Schema out = objectOf(std::move(members));
        std::vector<std::string_view> names = required<Flat>();
        for (const std::string_view each : required<T>()) names.push_back(each);
        const bool first = std::is_same_v<T, physics::SoftBodyDef>; // it needs no type
        if (!first && std::ranges::find(names, "type") == names.end()) names.emplace_back("type");
        if (!names.empty()) out["required"] = names;
        return out;
    };
    return {{"anyOf", {one.template operator()<Each>()...}}};
}
template <class Flat, HasFields Def> Schema flatSchema(const Def*)
{
    Schema members = properties<Def>();
    members.update(properties<Flat>());
    Schema out = objectOf(std::move(members));
    if (const auto names = required<Flat>(); !names.empty()) out["required"] = names;
    return out;
}

} // namespace

std::string sceneSchema()
{
    Schema defs, partial;
    std::set<std::string> seen;
    auto add = [&]<class T>() {
        if constexpr (std::is_same_v<T, TimedCommand>)
            defs[std::string(typeName<T>())] = flatSchema<T>(static_cast<const SceneCommand*>(nullptr));
        else if constexpr (kFlat<T>)
            defs[std::string(typeName<T>())] = flatSchema<T>(static_cast<const decltype(T::def)*>(nullptr));
        else
            defs[std::string(typeName<T>())] = wholeObject<T>();
        const bool partly = kFlat<T> || !required<T>().empty();
        partial[std::string(typeName<T>())] = partly ? objectOf(properties<T>()) : reference(typeName<T>());
    };
    DefWalk<SceneDef>::run(seen, add);
    defs["Defaults"] = objectOf(partial);
    Schema members = {{"$schema", {{"type", "string"}}}};
    members["include"] = {{"type", "array"},
                          {"items", {{"type", "string"}}},
                          {"description", "scene files whose bodies come before those of this one"}};
    members["defaults"] = reference("Defaults");
    members["classes"] = {{"type", "object"},
                          {"additionalProperties", reference("Defaults")},
                          {"description", "defaults for the objects that name the class"}};
    Schema own = properties<SceneDef>();
    own.erase("type");
    own.erase("class");
    members.update(own);
    Schema out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "A scene of Filasofia"}};
    out.update(objectOf(members));
    out["$defs"] = defs;
    return out.dump(2);
}

} // namespace filasofia::scene
