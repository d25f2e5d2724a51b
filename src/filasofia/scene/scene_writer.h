#pragma once

#include "filasofia/record/json_shapes.h"
#include "filasofia/scene/def_shapes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace filasofia::scene {

using Written = record::Json; ///< keeps members in their order

/// Whether two values of Defs are the same, bit for bit; meshes are if they are one object.
template <class T> bool same(const T& a, const T& b)
{
    if constexpr (std::is_same_v<T, double>) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    } else if constexpr (kIsOptional<T>) {
        return a.has_value() == b.has_value() && (!a || same(*a, *b));
    } else if constexpr (kIsVector<T> || kIsArray<T>) {
        return a.size() == b.size() &&
               std::equal(a.begin(), a.end(), b.begin(),
                          [](const typename T::value_type& x, const typename T::value_type& y) { return same(x, y); });
    } else if constexpr (kIsVariant<T>) {
        return a.index() == b.index() && std::visit(
                                             [&]<class Held>(const Held& held) {
                                                 const auto* other = std::get_if<Held>(&b);
                                                 return other && same(held, *other);
                                             },
                                             a);
    } else if constexpr (HasFields<T>) {
        bool all = true;
        forEachField<T>([&](const auto& each) { all = all && same(a.*(each.member), b.*(each.member)); });
        return all;
    } else {
        return a == b;
    }
}

/// Turns a scene into the JSON of a scene file, the inverse of SceneReader: what equals its default is left out, and
/// numbers are read back with the same bits. Meshes in memory, and files that are not in the scene's folder, become
/// files in a folder beside the scene.
class SceneWriter {
public:
    explicit SceneWriter(const std::filesystem::path& file);

    Written write(const SceneDef& scene);
    /// Writes the files that the scene names. Throws an Error before the first one if one is there already, unless it
    /// may be replaced.
    void writeFiles(bool overwrite) const;

private:
    /// `base` is what a reader has before it reads the value.
    template <class T> Written value(const T& it, const T& base)
    {
        if constexpr (std::is_same_v<T, double>)
            return number(it);
        else if constexpr (std::is_same_v<T, BodyId>)
            return bodies_.at(it.value - 1);
        else if constexpr (std::is_same_v<T, AttachmentId>)
            return attachmentName(it);
        else if constexpr (std::is_enum_v<T>)
            return names(&it)[static_cast<std::size_t>(it)];
        else if constexpr (IsMesh<T>)
            return std::visit([&](const auto& mesh) { return Written(meshFile(mesh)); }, it);
        else if constexpr (IsFile<T>)
            return std::visit([&](const auto& file) { return Written(otherFile(file)); }, it);
        else if constexpr (kIsOptional<T>) {
            static const typename T::value_type kFresh{}; // GCC warns of a temporary as uninitialized
            return it ? value(*it, base ? *base : kFresh) : Written();
        } else if constexpr (kIsVariant<T>)
            return std::visit([&]<class Held>(const Held& held) { return alternative(held, base); }, it);
        else if constexpr (kIsVector<T> || kIsArray<T>)
            return list(it);
        else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, Quat>)
            return numbers(it);
        else if constexpr (std::is_same_v<T, visual::Color>)
            return Written::array({number(it.red), number(it.green), number(it.blue)});
        else if constexpr (std::is_same_v<T, geometry::Box>)
            return Written::array({numbers(it.low), numbers(it.high)});
        else if constexpr (std::is_same_v<T, Pose>)
            return pose(it, base);
        else if constexpr (HasFields<T>)
            return object(it, base);
        else
            return it;
    }
    Written value(const SceneBody& it, const SceneBody& base);
    static Written number(double value);
    static Written pose(const Pose& it, const Pose& base);
    template <HasFields T> static Written numbers(const T& it)
    {
        Written list = Written::array();
        forEachField<T>([&](const auto& each) { list.push_back(number(it.*(each.member))); });
        return list;
    }
    template <class List> Written list(const List& values)
    {
        Written list = Written::array();
        using Member = typename List::value_type;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if constexpr (std::is_same_v<Member, bool>) // a list of flags has no references to its members
                list.push_back(static_cast<bool>(values[i]));
            else
                list.push_back(value(values[i], Member{}));
        }
        return list;
    }
    template <HasFields T> Written object(const T& it, const T& base)
    {
        Written json = Written::object();
        addMembers(json, it, base);
        return json;
    }
    template <class T> static bool isRequired(std::string_view name)
    {
        return std::ranges::count(required<T>(), name) > 0;
    }
    template <HasFields T> void addMembers(Written& json, const T& it, const T& base)
    {
        forEachField<T>([&](const auto& each) {
            const auto& mine = it.*(each.member);
            const auto& its = base.*(each.member);
            if constexpr (kFlat<T>)
                if (each.name.empty()) return addFlat<T>(json, mine, its);
            if (isRequired<T>(each.name) || !same(mine, its))
                json[std::string(each.name)] = isFile<T>(each.name) ? copied(mine) : value(mine, its);
        });
    }
    /// The members of what stands beside the other fields.
    template <class Outer, class T> void addFlat(Written& json, const T& it, const T& base)
    {
        if constexpr (kIsVariant<T>) {
            std::visit(
                [&]<class Held>(const Held& held) {
                    const auto* before = std::get_if<Held>(&base);
                    if (!before || isRequired<Outer>("type")) json["type"] = typeName<Held>();
                    addMembers(json, held, before ? *before : Held{});
                },
                it);
        } else if constexpr (HasFields<T>) {
            addMembers(json, it, base);
        }
    }
    /// Whether a text is the name of a file.
    template <class T> static constexpr bool isFile(std::string_view name)
    {
        return IsAnyOf<T, visual::TextureFile, visual::CustomMaterial> && name == "file";
    }
    template <class T> Written copied(const T& it)
    {
        if constexpr (std::is_same_v<T, std::string>) return otherFile(it);
        return {};
    }
    template <class Held, class Variant> Written alternative(const Held& held, const Variant& base)
    {
        if constexpr (HasFields<Held>) {
            const auto* before = std::get_if<Held>(&base);
            if (before) return object(held, *before);
            Written json = object(held, Held{});
            if (json.empty()) return typeName<Held>();
            Written typed = {{"type", typeName<Held>()}};
            typed.update(json);
            return typed;
        } else if constexpr (std::is_same_v<Held, double>) {
            return std::isfinite(held)
                       ? Written(held)
                       : number(held); // with ".0": without, it would be the alternative of whole numbers
        } else {
            return value(held, Held{});
        }
    }

    [[nodiscard]] Written attachmentName(AttachmentId id) const;
    // The name by which the scene calls a file or a mesh.
    /// A mesh file outside the scene's folder is written anew: it may need others beside it.
    std::string meshFile(const std::string& file);
    std::string meshFile(const TetPtr& mesh);
    std::string meshFile(const TrianglePtr& mesh);
    /// A file of another kind outside the scene's folder is copied.
    std::string otherFile(const std::string& file);
    static std::string otherFile(const std::shared_ptr<const device::Motion>& motion);
    std::string newMesh(const std::shared_ptr<const void>& mesh, std::string_view extension,
                        std::function<std::string()> bytes);
    /// Plans a new file in the scene's folder of files, named after what it holds, and returns its name in the scene.
    using Write = std::function<void(const std::filesystem::path&)>;
    std::string newFile(std::string_view name, std::string_view extension, Write write);
    /// The name of a file that comes with Filasofia or is in the scene's folder; else empty.
    [[nodiscard]] std::string nameOf(const std::string& file);

    const std::filesystem::path folder_; ///< the scene's
    const std::filesystem::path files_;  ///< the folder of its files
    std::vector<std::string> bodies_;    ///< the names of the bodies
    std::vector<std::string> attachments_;
    std::string current_ = "scene";                             ///< what is written now
    std::map<std::shared_ptr<const void>, std::string> meshes_; ///< names of meshes in memory
    std::map<std::string, std::string> written_;                ///< names of files by what they are copies of
    std::set<std::string> taken_;                               ///< names of new files
    std::set<std::filesystem::path> kept_;                      ///< files that the scene goes on naming
    std::vector<std::pair<std::filesystem::path, Write>> new_;  ///< what writeFiles() writes
};

} // namespace filasofia::scene
