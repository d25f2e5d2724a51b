#include "filasofia/visual/material_overrides.h"

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"

#include <algorithm>

namespace filasofia::visual {
namespace {

template <class T> std::string_view kindOf()
{
    if constexpr (std::is_same_v<T, double>)
        return "number";
    else if constexpr (std::is_same_v<T, int>)
        return "whole number";
    else if constexpr (std::is_same_v<T, bool>)
        return "flag";
    else if constexpr (std::is_same_v<T, Color>)
        return "colour";
    else if constexpr (std::is_same_v<T, Vec3>)
        return "vector";
    else if constexpr (std::is_same_v<T, Texture> || std::is_same_v<T, TextureMap>)
        return "texture";
    else
        return "list of four numbers";
}

/// The map that a picture of an override is; `where` names both in errors.
TextureMap mapOf(const Texture& given, const std::string& where)
{
    if (const auto* view = std::get_if<ViewPicture>(&given))
        fail(where, ": must be a file, not the picture of view '", view->view, "'");
    if (const auto* file = std::get_if<TextureFile>(&given)) return *file;
    return NoTexture{};
}

/// Sets a field to a value of its type; `where` names both in errors.
template <class Value> void assign(Value& field, const ParameterValue& value, const std::string& where)
{
    std::visit(
        [&](const auto& given) {
            using Given = std::remove_cvref_t<decltype(given)>;
            constexpr bool widened = std::is_same_v<Value, double> && std::is_same_v<Given, int>;
            if constexpr (std::is_same_v<Given, Value> || widened) {
                field = given;
            } else if constexpr (std::is_same_v<Value, TextureMap> && std::is_same_v<Given, Texture>) {
                field = mapOf(given, where);
            } else {
                fail(where, ": must be a ", kindOf<Value>(), ", got a ", kindOf<Given>());
            }
        },
        value);
}

[[noreturn]] void failUnknown(const std::string& object, std::string_view type, const std::string& name,
                              const std::vector<std::string>& known)
{
    const std::string near = didYouMean(name, known);
    std::string all;
    for (const std::string& each : known) all += (all.empty() ? "" : ", ") + each;
    fail(object, ": ", type, " has no parameter '", name, "'", near.empty() ? text("; it has ", all) : near);
}

template <class Held> void overrideField(Held& held, const MaterialParameter& given, const std::string& object)
{
    std::vector<std::string> known;
    bool found = false;
    forEachField<Held>([&](const auto& each) {
        known.emplace_back(each.name);
        if (each.name != given.name) return;
        found = true;
        assign(held.*(each.member), given.value, text(object, ": override '", given.name, "'"));
    });
    if (!found) failUnknown(object, fields(&held).typeName, given.name, known);
}

void overrideField(CustomMaterial& held, const MaterialParameter& given, const MaterialPackage& package,
                   const std::string& object)
{
    if (!package.find(given.name)) {
        std::vector<std::string> known;
        for (const auto& each : package.parameters)
            if (!each.name.starts_with('_')) known.push_back(each.name); // the others are the compiler's own
        failUnknown(object, text("material file '", held.file, "'"), given.name, known);
    }
    std::erase_if(held.parameters, [&](const MaterialParameter& each) { return each.name == given.name; });
    held.parameters.push_back(given); // its type is checked with those of the pool's parameters
}

} // namespace

Material overridden(const Material& base, const std::vector<MaterialParameter>& overrides,
                    const MaterialPackage* package, const std::string& object)
{
    Material made = base;
    for (std::size_t i = 0; i < overrides.size(); ++i) {
        const MaterialParameter& given = overrides[i];
        for (std::size_t before = 0; before < i; ++before)
            if (overrides[before].name == given.name) fail(object, ": override '", given.name, "' is given twice");
        std::visit(
            [&](auto& held) {
                using Held = std::remove_cvref_t<decltype(held)>;
                if constexpr (std::is_same_v<Held, CustomMaterial>)
                    overrideField(held, given, *package, object);
                else if constexpr (!std::is_same_v<Held, NamedMaterial>) // the pool has none
                    overrideField(held, given, object);
            },
            made);
    }
    return made;
}

} // namespace filasofia::visual
