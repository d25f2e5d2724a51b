#pragma once

#include "convert.h"

#include "filasofia/math/pose.h"
#include "filasofia/visual/color.h"

#include <cctype>
#include <cstddef>

/// Convert<> of Defs and of variants; the second half of convert.h.
namespace filasofia::python {

/// Whether a sequence of numbers may stand for a small Def.
template <class T> inline constexpr std::size_t kPlainNumbers = 0;
template <> inline constexpr std::size_t kPlainNumbers<visual::Color> = 3;
template <class T> constexpr bool takesPlain() { return kPlainNumbers<T> != 0; }

/// A Pose may be given by 3 numbers, its position, or by 7, as frames give it.
inline Pose readPoseNumbers(nb::handle value, const Where& where)
{
    constexpr const char* kMust = "must be a Pose, 3 numbers (its position) or 7 (position and w, x, y, z)";
    const nb::object members = readShortSequence(value, where, kMust, 7);
    double v[7] = {0, 0, 0, 1, 0, 0, 0};
    const std::size_t count = nb::len(members);
    if (count != 3 && count != 7) failValue(where, kMust, value);
    readNumbers(members, where, kMust, v, count);
    return {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
}

template <HasFields T> struct Convert<T> {
    static T read(nb::handle value, const Where& where)
    {
        if constexpr (std::is_same_v<T, Pose>)
            if (isSequence(value)) return readPoseNumbers(value, where);
        if constexpr (takesPlain<T>())
            if (isSequence(value)) return readPlain(value, where);
        if (!takes(value)) failClass(value, where);
        T out;
        std::size_t index = 0;
        forEachField<T>([&](const auto& each) {
            using Value = std::remove_cvref_t<decltype(out.*(each.member))>;
            const std::string& name = fieldNames<T>()[index++];
            const nb::object held = value.attr(name.c_str());
            const Where inner{.outer = &where, .name = name, .range = each.range, .unit = each.unit};
            out.*(each.member) = Convert<Value>::read(held, inner);
        });
        return out;
    }
    static nb::object make(const T& value)
    {
        const nb::handle type = classOf(typeName<T>());
        nb::object out = type.attr("__new__")(type);
        std::size_t index = 0;
        forEachField<T>([&](const auto& each) {
            using Value = std::remove_cvref_t<decltype(value.*(each.member))>;
            const nb::object held = Convert<Value>::make(value.*(each.member));
            const nb::str name(fieldNames<T>()[index++].c_str());
            // Past the class's own __setattr__, which would check what is right.
            if (PyObject_GenericSetAttr(out.ptr(), name.ptr(), held.ptr()) != 0) throw nb::python_error();
        });
        return out;
    }
    static nb::object keep(nb::handle value, const Where& where)
    {
        const T read = Convert<T>::read(value, where); // also what was put into its lists since
        return takes(value) ? nb::borrow(value) : make(read);
    }
    static bool takes(nb::handle value) { return isOf(value, typeName<T>()); }
    static std::string typing()
    {
        if constexpr (std::is_same_v<T, Pose>) return "Pose | Sequence[float]";
        if constexpr (takesPlain<T>()) return std::string(typeName<T>()) + " | Sequence[float]";
        return std::string(typeName<T>());
    }

private:
    static T readPlain(nb::handle value, const Where& where)
    {
        const nb::object members = readSequence(value, where, "must be a list of numbers");
        if (nb::len(members) != kPlainNumbers<T>)
            failValue(where, text("must be ", kPlainNumbers<T>, " numbers"), value);
        T out;
        std::size_t index = 0;
        forEachField<T>([&](const auto& each) {
            const nb::object held = members[index];
            const Where inner{.outer = &where, .index = index, .range = each.range, .unit = each.unit};
            out.*(each.member) = readNumber(held, inner);
            ++index;
        });
        return out;
    }
    [[noreturn]] static void failClass(nb::handle value, const Where& where)
    {
        const std::string name = defName(value);
        const std::string hint = name == typeName<T>() ? text(" (did you mean ", name, "()?)") : std::string();
        const std::string must = " must be " + withArticle(typeName<T>());
        throw nb::type_error(text(where.text(), must, ", got ", shown(value), hint).c_str());
    }
};

template <class... T> struct Convert<std::variant<T...>> {
    using Variant = std::variant<T...>;

    static Variant read(nb::handle value, const Where& where)
    {
        Variant out;
        if (!(attempt<T>(value, [&] { out = Convert<T>::read(value, where); }) || ...)) failNone(value, where);
        return out;
    }
    static nb::object make(const Variant& value)
    {
        return std::visit([](const auto& held) { return Convert<std::remove_cvref_t<decltype(held)>>::make(held); },
                          value);
    }
    static nb::object keep(nb::handle value, const Where& where)
    {
        nb::object out;
        if (!(attempt<T>(value, [&] { out = Convert<T>::keep(value, where); }) || ...)) failNone(value, where);
        return out;
    }
    static bool takes(nb::handle value) { return (Convert<T>::takes(value) || ...); }
    static std::string typing()
    {
        std::string out;
        ((out += (out.empty() ? "" : " | ") + Convert<T>::typing()), ...);
        return out;
    }

private:
    template <class One, class Do> static bool attempt(nb::handle value, Do&& act)
    {
        // A whole number is no double if the variant holds both.
        constexpr bool both = std::is_same_v<One, double> && (std::is_same_v<T, int> || ...);
        if (both ? !PyFloat_Check(value.ptr()) : !Convert<One>::takes(value)) return false;
        act();
        return true;
    }
    [[noreturn]] static void failNone(nb::handle value, const Where& where)
    {
        const std::string must = text("must be one of ", typing());
        std::vector<std::string> known;
        (known.push_back(Convert<T>::typing()), ...);
        // A word, or the class in place of an instance: what was probably meant.
        std::string given = PyType_Check(value.ptr()) ? defName(value) : std::string();
        if (isText(value)) given = readText(value, where);
        std::string hint;
        for (const std::string& each : known)
            if (sameLetters(each, given)) hint = text(" (did you mean ", each, "()?)");
        throw nb::type_error(text(where.text(), " ", must, ", got ", shown(value), hint).c_str());
    }
    static bool sameLetters(std::string_view a, std::string_view b)
    {
        return snakeCase(a) == snakeCase(b) || lowered(a) == lowered(b);
    }
    static std::string lowered(std::string_view word)
    {
        std::string out;
        for (const char letter : word) out += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
        return out;
    }
};

} // namespace filasofia::python
