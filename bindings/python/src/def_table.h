#pragma once

#include "convert.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace filasofia::python {

/// One field of a Def, with its type erased.
struct FieldEntry {
    std::string name; ///< in Python
    std::string_view unit;
    Range range;
    std::string_view meaning;
    std::string typing;
    nb::object (*keep)(nb::handle value, const Where& where);
};
/// One Def.
struct DefEntry {
    std::string name;
    std::vector<FieldEntry> fields;
    nb::object (*defaults)(); ///< a new tuple of the fields' defaults
};

/// The Defs that were added and all that their fields name.
class DefTable {
public:
    template <class T> void add() { Visit<T>::apply(*this); }
    [[nodiscard]] const std::vector<DefEntry>& entries() const { return entries_; }

private:
    /// Looks for Defs in a type.
    template <class T> struct Visit {
        static void apply(DefTable& table)
        {
            if constexpr (HasFields<T> && !std::is_same_v<T, Vec3> && !std::is_same_v<T, Quat>) table.addDef<T>();
        }
    };
    template <class T> struct Visit<std::vector<T>> : Visit<T> {
    };
    template <class T> struct Visit<std::optional<T>> : Visit<T> {
    };
    template <class... T> struct Visit<std::variant<T...>> {
        static void apply(DefTable& table) { (Visit<T>::apply(table), ...); }
    };

    template <HasFields T> void addDef()
    {
        if (!seen_.insert(std::string(typeName<T>())).second) return;
        DefEntry entry{.name = std::string(typeName<T>()), .fields = {}, .defaults = [] {
                           const T def{};
                           nb::list values;
                           forEachField<T>([&](const auto& each) {
                               using Value = std::remove_cvref_t<decltype(def.*(each.member))>;
                               values.append(Convert<Value>::make(def.*(each.member)));
                           });
                           return nb::object(nb::tuple(values));
                       }};
        forEachField<T>([&](const auto& each) {
            using Value = std::remove_cvref_t<decltype(std::declval<T&>().*(each.member))>;
            Visit<Value>::apply(*this); // before the Def that holds it
            entry.fields.push_back({.name = snakeCase(each.name),
                                    .unit = each.unit,
                                    .range = each.range,
                                    .meaning = each.meaning,
                                    .typing = Convert<Value>::typing(),
                                    .keep = &Convert<Value>::keep});
        });
        entries_.push_back(std::move(entry));
    }

    std::vector<DefEntry> entries_;
    std::set<std::string> seen_;
};

} // namespace filasofia::python
