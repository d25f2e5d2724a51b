#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/core/text.h"
#include "filasofia/math/vec3.h"

#include <imgui.h>

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

/// Shows any Def as lines of "name value unit", read from its fields() list.
namespace filasofia::runtime {

template <HasFields T> void drawFields(const T& def);

namespace detail {

inline void line(std::string_view name, const std::string& value, std::string_view unit)
{
    const std::string shown = unit.empty() || unit == "-" ? value : text(value, " ", unit);
    ImGui::TextDisabled("%s", std::string(name).c_str());
    ImGui::SameLine();
    ImGui::TextUnformatted(shown.c_str());
}

inline std::string written(double value)
{
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
}

template <class T> struct Draw {
    static void apply(std::string_view name, const T& value, std::string_view unit)
    {
        if constexpr (std::is_same_v<T, bool>) {
            line(name, value ? "yes" : "no", unit);
        } else if constexpr (std::is_arithmetic_v<T>) {
            line(name, written(double(value)), unit);
        } else if constexpr (std::is_same_v<T, std::string>) {
            line(name, value, unit);
        } else if constexpr (std::is_same_v<T, Vec3>) {
            line(name, written(value.x) + " " + written(value.y) + " " + written(value.z), unit);
        } else if constexpr (HasFields<T>) {
            if (ImGui::TreeNode(std::string(name).c_str())) {
                drawFields(value);
                ImGui::TreePop();
            }
        }
        // Meshes are shared data and have no line: the picture shows them.
    }
};

template <class T> struct Draw<std::optional<T>> {
    static void apply(std::string_view name, const std::optional<T>& value, std::string_view unit)
    {
        if (value) Draw<T>::apply(name, *value, unit);
    }
};

template <class... T> struct Draw<std::variant<T...>> {
    static void apply(std::string_view name, const std::variant<T...>& value, std::string_view unit)
    {
        std::visit([&](const auto& held) { Draw<std::remove_cvref_t<decltype(held)>>::apply(name, held, unit); },
                   value);
    }
};

template <class T> struct Draw<std::vector<T>> {
    static void apply(std::string_view name, const std::vector<T>& values, std::string_view)
    {
        constexpr std::size_t maxShown = 20; // nobody reads a list of a thousand nodes
        const std::string title = std::string(name) + " (" + std::to_string(values.size()) + ")";
        if (values.empty() || !ImGui::TreeNode(title.c_str())) return;
        for (std::size_t i = 0; i < std::min(values.size(), maxShown); ++i)
            Draw<T>::apply(std::to_string(i), values[i], "");
        if (values.size() > maxShown) ImGui::TextDisabled("and %zu more", values.size() - maxShown);
        ImGui::TreePop();
    }
};

} // namespace detail

template <HasFields T> void drawFields(const T& def)
{
    forEachField<T>([&](const auto& each) {
        using Value = std::remove_cvref_t<decltype(def.*(each.member))>;
        detail::Draw<Value>::apply(each.name, def.*(each.member), each.unit);
    });
}

} // namespace filasofia::runtime
