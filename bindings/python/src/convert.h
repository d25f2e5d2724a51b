#pragma once

#include "classes.h"
#include "meshes.h"
#include "names.h"
#include "scalars.h"

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/runtime/show.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

/// How the values of Defs are read from Python and made for it. Convert<T> has for each shape of T:
///
///     read(value, where)   the value, checked against the bounds of its field; throws TypeError or filasofia.Error
///     make(value)          a new Python object
///     keep(value, where)   what a Def in Python stores of what it was given, checked; numbers and texts are Python's
///     takes(value)         whether an alternative of a variant is meant; a wrong value may still be refused
///     typing()             its type as annotations write it
namespace filasofia::python {

template <class T> struct Convert;

/// The names of a Def's fields in Python, in the order of its list.
template <HasFields T> const std::vector<std::string>& fieldNames()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> made;
        forEachField<T>([&](const auto& each) { made.push_back(snakeCase(each.name)); });
        return made;
    }();
    return names;
}
template <HasFields T> constexpr std::string_view typeName() { return fields(static_cast<const T*>(nullptr)).typeName; }

/// Shapes that are stored as they are made anew.
template <class T> struct KeepNew {
    static nb::object keep(nb::handle value, const Where& where)
    {
        return Convert<T>::make(Convert<T>::read(value, where));
    }
};

template <> struct Convert<double> : KeepNew<double> {
    static double read(nb::handle value, const Where& where) { return readNumber(value, where); }
    static nb::object make(double value) { return nb::float_(value); }
    static bool takes(nb::handle value) { return isNumber(value); }
    static std::string typing() { return "float"; }
};
template <class Whole>
requires(std::integral<Whole> && !std::same_as<Whole, bool>) struct Convert<Whole> : KeepNew<Whole> {
    static Whole read(nb::handle value, const Where& where)
    {
        constexpr auto high = std::numeric_limits<Whole>::max();
        constexpr auto most = std::numeric_limits<std::int64_t>::max();
        const std::int64_t limit = static_cast<std::uint64_t>(high) > static_cast<std::uint64_t>(most) ? most : high;
        return static_cast<Whole>(readWhole(value, where, std::numeric_limits<Whole>::min(), limit));
    }
    static nb::object make(Whole value) { return nb::int_(value); }
    static bool takes(nb::handle value) { return isWhole(value); }
    static std::string typing() { return "int"; }
};
template <> struct Convert<bool> : KeepNew<bool> {
    static bool read(nb::handle value, const Where& where) { return readFlag(value, where); }
    static nb::object make(bool value) { return nb::bool_(value); }
    static bool takes(nb::handle value) { return isFlag(value); }
    static std::string typing() { return "bool"; }
};
template <> struct Convert<std::string> : KeepNew<std::string> {
    static std::string read(nb::handle value, const Where& where) { return readText(value, where); }
    static nb::object make(const std::string& value) { return nb::str(value.c_str(), value.size()); }
    static bool takes(nb::handle value) { return isText(value) || nb::hasattr(value, "__fspath__"); }
    static std::string typing() { return "str"; }
};
template <> struct Convert<Vec3> : KeepNew<Vec3> {
    static Vec3 read(nb::handle value, const Where& where)
    {
        double v[3] = {};
        readNumbers(value, where, "must be 3 numbers", v, 3);
        return {v[0], v[1], v[2]};
    }
    static nb::object make(const Vec3& value) { return tupleOf(&value.x, 3); }
    static bool takes(nb::handle value) { return isSequence(value) && nb::len(value) == 3; }
    static std::string typing() { return "Vec3"; }
};
template <> struct Convert<Quat> : KeepNew<Quat> {
    static Quat read(nb::handle value, const Where& where)
    {
        double v[4] = {};
        readNumbers(value, where, "must be 4 numbers: w, x, y, z", v, 4);
        return {v[0], v[1], v[2], v[3]};
    }
    static nb::object make(const Quat& value) { return tupleOf(&value.w, 4); }
    static bool takes(nb::handle value) { return isSequence(value) && nb::len(value) == 4; }
    static std::string typing() { return "Quat"; }
};
template <std::size_t n> struct Convert<std::array<double, n>> : KeepNew<std::array<double, n>> {
    static std::array<double, n> read(nb::handle value, const Where& where)
    {
        std::array<double, n> v = {};
        readNumbers(value, where, text("must be ", n, " numbers"), v.data(), n);
        return v;
    }
    static nb::object make(const std::array<double, n>& value) { return tupleOf(value.data(), n); }
    static bool takes(nb::handle value) { return isSequence(value) && nb::len(value) == n; }
    static std::string typing() { return "Sequence[float]"; }
};

/// Ids are numbers of a class of their own; None is no body.
template <class Id> struct ConvertId : KeepNew<Id> {
    static Id read(nb::handle value, const Where& where)
    {
        if (value.is_none()) return {};
        return {static_cast<std::uint32_t>(readWhole(value, where, 0, std::numeric_limits<std::uint32_t>::max()))};
    }
    static nb::object make(Id value) { return value ? classOf(Convert<Id>::kName)(value.value) : nb::none(); }
    static bool takes(nb::handle value) { return value.is_none() || isWhole(value); }
    static std::string typing() { return std::string(Convert<Id>::kName) + " | None"; }
};
template <> struct Convert<BodyId> : ConvertId<BodyId> {
    static constexpr const char* kName = "BodyId";
};
template <> struct Convert<AttachmentId> : ConvertId<AttachmentId> {
    static constexpr const char* kName = "AttachmentId";
};
template <> struct Convert<runtime::ShownId> : ConvertId<runtime::ShownId> {
    static constexpr const char* kName = "ShownId";
};

/// An enumeration is one of its words.
template <class T>
requires std::is_enum_v<T>
struct Convert<T> : KeepNew<T> {
    static T read(nb::handle value, const Where& where)
    {
        const auto words = names(static_cast<const T*>(nullptr));
        std::string all;
        std::vector<std::string> known;
        const std::string given = isText(value) ? readText(value, where) : std::string();
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (isText(value) && given == words[i]) return static_cast<T>(i);
            all += text(i == 0 ? "'" : i + 1 == words.size() ? " or '" : ", '", words[i], "'");
            known.emplace_back(words[i]);
        }
        if (!isText(value)) failType(where, "must be " + all, value);
        fail(where.text(), " must be ", all, ", got ", shown(value), didYouMean(given, known));
    }
    static nb::object make(T value)
    {
        const std::string_view word = names(&value)[static_cast<std::size_t>(value)];
        return nb::str(word.data(), word.size());
    }
    static bool takes(nb::handle value) { return isText(value); }
    static std::string typing()
    {
        std::string out;
        for (const std::string_view word : names(static_cast<const T*>(nullptr)))
            out += text(out.empty() ? "Literal['" : ", '", word, "'");
        return out + "]";
    }
};

/// Meshes are shared: nobody changes one.
template <class Mesh> struct Convert<std::shared_ptr<const Mesh>> {
    using Shared = std::shared_ptr<const Mesh>;
    static Shared read(nb::handle value, const Where& where)
    {
        if (!takes(value)) failType(where, text("must be a ", kMeshName<Mesh>), value);
        return nb::cast<const SharedMesh<Mesh>&>(value).mesh;
    }
    static nb::object make(const Shared& value) { return value ? nb::cast(SharedMesh<Mesh>{value}) : nb::none(); }
    static nb::object keep(nb::handle value, const Where& where) { return read(value, where), nb::borrow(value); }
    static bool takes(nb::handle value) { return nb::isinstance<SharedMesh<Mesh>>(value); }
    static std::string typing() { return kMeshName<Mesh>; }
};

template <class T> struct Convert<std::optional<T>> {
    static std::optional<T> read(nb::handle value, const Where& where)
    {
        if (value.is_none()) return std::nullopt;
        return Convert<T>::read(value, where);
    }
    static nb::object make(const std::optional<T>& value) { return value ? Convert<T>::make(*value) : nb::none(); }
    static nb::object keep(nb::handle value, const Where& where)
    {
        return value.is_none() ? nb::none() : Convert<T>::keep(value, where);
    }
    static bool takes(nb::handle value) { return value.is_none() || Convert<T>::takes(value); }
    static std::string typing() { return Convert<T>::typing() + " | None"; }
};

template <class T> struct Convert<std::vector<T>> {
    static constexpr const char* kMust = "must be a list";
    static std::vector<T> read(nb::handle value, const Where& where)
    {
        const nb::object members = readSequence(value, where, kMust);
        std::vector<T> out;
        out.reserve(nb::len(members));
        for (std::size_t i = 0; i < nb::len(members); ++i) {
            const nb::object each = members[i];
            out.push_back(Convert<T>::read(each, where.at(i)));
        }
        return out;
    }
    static nb::object make(const std::vector<T>& value)
    {
        nb::list out;
        for (const T& each : value) out.append(Convert<T>::make(each));
        return out;
    }
    static nb::object keep(nb::handle value, const Where& where)
    {
        const nb::object members = readSequence(value, where, kMust);
        nb::list out;
        for (std::size_t i = 0; i < nb::len(members); ++i) {
            const nb::object each = members[i];
            out.append(Convert<T>::keep(each, where.at(i)));
        }
        return out;
    }
    static bool takes(nb::handle value) { return isSequence(value); }
    static std::string typing() { return "Sequence[" + Convert<T>::typing() + "]"; }
};

/// As many of a kind as the member has.
template <class T, std::size_t n> struct Convert<std::array<T, n>> {
    using List = Convert<std::vector<T>>;
    static std::array<T, n> read(nb::handle value, const Where& where)
    {
        const std::vector<T> members = List::read(value, where);
        if (members.size() != n) failValue(where, text("must be a list of ", n), value);
        std::array<T, n> out = {};
        std::ranges::copy(members, out.begin());
        return out;
    }
    static nb::object make(const std::array<T, n>& value) { return List::make({value.begin(), value.end()}); }
    static nb::object keep(nb::handle value, const Where& where)
    {
        read(value, where);
        return List::keep(value, where);
    }
    static bool takes(nb::handle value) { return List::takes(value) && nb::len(value) == n; }
    static std::string typing() { return List::typing(); }
};

/// An argument of a function, whose errors begin "set_pose: pose must be ...". None is no id here.
template <class T>
T readArgument(nb::handle value, std::string_view function, std::string_view name, Range range = finite())
{
    const Where object{.name = function};
    const Where where{.outer = &object, .name = name, .range = range};
    if constexpr (std::is_base_of_v<ConvertId<T>, Convert<T>>)
        if (value.is_none()) failType(where, "must be " + withArticle(Convert<T>::kName), value);
    return Convert<T>::read(value, where);
}

} // namespace filasofia::python

#include "convert_defs.h"
