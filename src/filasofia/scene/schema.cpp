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
    if (!std::isfinite(range.most)) return;
    if (!std::isfinite(range.low)) to["minimum"] = -range.most;
    if (!std::isfinite(range.high)) to["maximum"] = range.most;
}

// What needs no types is no template: JSON is built by much code, which took each of hundreds of types a third of a
// second to compile.
Schema typed(const char* type) { return {{"type", type}}; }
Schema described(const char* type, const char* meaning) { return {{"type", type}, {"description", meaning}}; }
Schema anyOf(const std::vector<Schema>& each) { return {{"anyOf", each}}; }
Schema number(const Range& range)
{
    Schema out = {{"type", {"number", "string"}}};
    addBounds(range, out);
    return out;
}
Schema whole(const Range& range)
{
    Schema out = typed("integer");
    addBounds(range, out);
    return out;
}
Schema list(const Schema& items) { return {{"type", "array"}, {"items", items}}; }
Schema list(const Schema& items, std::size_t count)
{
    return {{"type", "array"}, {"items", items}, {"minItems", count}, {"maxItems", count}};
}
Schema numbers(const Range& range, std::size_t count) { return anyOf({list(number(range), count), typed("string")}); }
Schema rotation(const Range& range)
{
    return anyOf({numbers(range, 4),
                  {{"type", "object"},
                   {"properties", {{"axis", numbers(finite(), 3)}, {"angle", number(finite())}}},
                   {"required", {"axis", "angle"}},
                   {"additionalProperties", false}}});
}
Schema oneWord(const std::vector<std::string>& words) { return {{"enum", words}}; }
Schema withType(std::string_view type) { return {{"allOf", {reference(type)}}, {"required", {"type"}}}; }

/// Adds a Def to the alternatives of a variant. The first one needs no type: it is the one that fields have by default.
void addDef(std::string_view type, std::vector<Schema>& all, std::vector<std::string>& words)
{
    all.push_back(all.empty() ? reference(type) : withType(type));
    words.emplace_back(type);
}

/// The schema of a type's values, with the bounds and the unit of their field.
template <class T> struct ValueSchema {
    static Schema of(const Range& range)
    {
        if constexpr (std::is_same_v<T, double>)
            return number(range);
        else if constexpr (std::is_same_v<T, bool>)
            return typed("boolean");
        else if constexpr (std::is_integral_v<T>)
            return whole(range);
        else if constexpr (std::is_same_v<T, std::string> || IsFile<T>)
            return typed("string");
        else if constexpr (std::is_same_v<T, BodyId>)
            return described("string", "name of a body before this one");
        else if constexpr (std::is_same_v<T, AttachmentId>)
            return described("string", "name of an attachment");
        else if constexpr (std::is_enum_v<T>) {
            const auto all = names(static_cast<const T*>(nullptr));
            return oneWord({all.begin(), all.end()});
        } else if constexpr (IsMesh<T>)
            return anyOf({typed("string"), ValueSchema<typename MeshShapes<T>::Shapes>::typed()});
        else if constexpr (std::is_same_v<T, Vec3>)
            return numbers(range, 3);
        else if constexpr (std::is_same_v<T, Quat>)
            return rotation(range);
        else if constexpr (std::is_same_v<T, Pose>)
            return anyOf({reference("Pose"), numbers(range, 3)});
        else if constexpr (std::is_same_v<T, visual::Color>)
            return anyOf({numbers(closed(0, 1), 3), reference("Color")});
        else if constexpr (std::is_same_v<T, geometry::Box>)
            return anyOf({list(numbers(range, 3), 2), reference("Box")});
        else
            return reference(typeName<T>());
    }
};
template <class T> struct ValueSchema<std::optional<T>> {
    static Schema of(const Range& range) { return anyOf({ValueSchema<T>::of(range), typed("null")}); }
};
template <class T> struct ValueSchema<std::vector<T>> {
    static Schema of(const Range& range) { return list(ValueSchema<T>::of(range)); }
};
template <class T, std::size_t n> struct ValueSchema<std::array<T, n>> {
    static Schema of(const Range& range)
    {
        if constexpr (std::is_same_v<T, double>)
            return numbers(range, n);
        else
            return list(ValueSchema<T>::of(range), n);
    }
};
template <class... Each>
requires(!IsMesh<std::variant<Each...>> && !IsFile<std::variant<Each...>>) struct ValueSchema<std::variant<Each...>> {
    static Schema of(const Range& range)
    {
        std::vector<Schema> all;
        std::vector<std::string> words;
        const auto add = [&]<class T>() {
            if constexpr (HasFields<T> && !std::is_same_v<T, Vec3>)
                addDef(typeName<T>(), all, words);
            else if constexpr (!std::is_same_v<T, Vec3>)
                all.push_back(ValueSchema<T>::of(range));
        };
        (add.template operator()<Each>(), ...);
        all.push_back(oneWord(words));
        if constexpr (IsAnyOf<visual::TextureFile, Each...>) all.push_back(described("string", "a PNG or JPEG file"));
        return anyOf(all);
    }
    static Schema typed() { return anyOf({withType(typeName<Each>())...}); }
};

/// The default of a field as a file would write it; null if that is no number, flag, word or vector.
template <class T> Schema preset(const T& value)
{
    if constexpr (std::is_same_v<T, double>)
        return std::isnan(value)      ? Schema()
               : std::isfinite(value) ? Schema(value)
                                      : Schema(value > 0.0 ? record::kInfinite : record::kMinusInfinite);
    else if constexpr (std::is_same_v<T, bool> || std::is_integral_v<T>)
        return value;
    else if constexpr (std::is_same_v<T, std::string>)
        return value.empty() ? Schema() : Schema(value);
    else if constexpr (std::is_enum_v<T>)
        return names(&value)[static_cast<std::size_t>(value)];
    else if constexpr (std::is_same_v<T, Vec3>)
        return Schema::array({value.x, value.y, value.z});
    else
        return {};
}

/// A field, with the schema of its value and its default.
struct Property {
    std::string_view name, unit, meaning;
    Schema value, preset;
};
Schema propertiesOf(std::string_view type, const std::vector<Property>& fields)
{
    Schema out = {{"type", {{"const", type}}}, {"class", typed("string")}};
    if (type == typeName<physics::FemMaterial>()) {
        std::vector<std::string> known;
        for (const physics::Tissue& each : physics::tissues()) known.emplace_back(each.name);
        out["tissue"] = oneWord(known);
        out["tissue"]["description"] = "a tissue of the library, with whose constants and density it begins";
    }
    for (const Property& each : fields) {
        if (each.name.empty()) continue;
        const bool bare = each.unit.empty() || each.unit == "-";
        Schema& member = out[std::string(each.name)] = each.value;
        member["description"] = bare ? std::string(each.meaning) : text(each.meaning, " [", each.unit, "]");
        if (!each.preset.is_null()) member["default"] = each.preset;
    }
    return out;
}
template <HasFields T> Schema properties()
{
    std::vector<Property> list;
    const T object{};
    const std::vector<std::string_view> needed = required<T>(); // they have no default that a file may rely on
    forEachField<T>([&](const auto& each) {
        using Value = std::remove_cvref_t<decltype(std::declval<T&>().*(each.member))>;
        const bool isNeeded = std::ranges::find(needed, each.name) != needed.end();
        list.push_back({each.name, each.unit, each.meaning, ValueSchema<Value>::of(each.range),
                        isNeeded ? Schema() : preset(object.*(each.member))});
    });
    return propertiesOf(typeName<T>(), list);
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
        const bool first = std::is_same_v<T, std::variant_alternative_t<0, std::variant<Each...>>>; // the default
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

/// The Def whose fields stand beside those of a flat type.
template <class T> struct Beside {
    using Def = decltype(T::def);
};
template <> struct Beside<TimedCommand> {
    using Def = SceneCommand;
};
template <> struct Beside<prefab::SensorDef> {
    using Def = prefab::SensorKind;
};

} // namespace

std::string sceneSchema()
{
    Schema defs, partial;
    std::set<std::string> seen;
    auto add = [&]<class T>() {
        if constexpr (kFlat<T>)
            defs[std::string(typeName<T>())] = flatSchema<T>(static_cast<const typename Beside<T>::Def*>(nullptr));
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
