#pragma once

#include "filasofia/record/json_shapes.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace filasofia::record {

/// Turns values into JSON. Numbers are written in full: read back, they have the same bits.
class JsonWriter {
public:
    template <class T> Json write(const T& value)
    {
        if constexpr (std::is_same_v<T, double>)
            return number(value);
        else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>)
            return value;
        else if constexpr (std::is_same_v<T, BodyId> || std::is_same_v<T, AttachmentId>)
            return value.value;
        else if constexpr (std::is_enum_v<T>)
            return names(&value)[static_cast<std::size_t>(value)];
        else if constexpr (std::is_same_v<T, TetMesh> || std::is_same_v<T, TriangleMesh>)
            return numberOf(value);
        else if constexpr (IsMeshSource<T>)
            return std::visit([this](const auto& source) { return this->write(source); }, value);
        else if constexpr (kIsOptional<T>)
            return value ? write(*value) : Json();
        else if constexpr (kIsShared<T>)
            return write(*value);
        else if constexpr (kIsVariant<T>)
            return std::visit([this](const auto& held) { return this->named(held); }, value);
        else if constexpr (kIsVector<T> || kIsArray<T>)
            return list(value);
        else
            return object(value);
    }

    /// The meshes that were found since the last call; their numbers continue from one call to the next.
    std::vector<Mesh> takeNewMeshes()
    {
        std::vector<Mesh> fresh(meshes_.begin() + static_cast<std::ptrdiff_t>(handedOut_), meshes_.end());
        handedOut_ = meshes_.size();
        return fresh;
    }

private:
    static Json number(double value)
    {
        if (std::isinf(value)) return value > 0 ? kInfinite : kMinusInfinite;
        if (std::isnan(value)) fail("a recording cannot hold NaN");
        return value;
    }
    template <class T> Json named(const T& held)
    {
        Json json = Json::object();
        json[std::string(typeName<T>())] = write(held);
        return json;
    }
    template <class List> Json list(const List& values)
    {
        Json json = Json::array();
        for (const auto& each : values) json.push_back(write(each));
        return json;
    }
    template <HasFields T> Json object(const T& value)
    {
        Json json = IsPlaces<T> ? Json::array() : Json::object();
        [[maybe_unused]] std::size_t index = 0;
        [[maybe_unused]] const T usual{};
        forEachField<T>([&](const auto& each) {
            if constexpr (HasAddedFields<T>)
                if (index++ >= firstFields<T>() && value.*(each.member) == usual.*(each.member)) return;
            if constexpr (IsPlaces<T>)
                json.push_back(write(value.*(each.member)));
            else
                json[std::string(each.name)] = write(value.*(each.member));
        });
        return json;
    }

    template <class T> static bool sameBits(const std::vector<T>& a, const std::vector<T>& b)
    {
        using Bits = std::array<std::uint64_t, sizeof(T) / sizeof(std::uint64_t)>; // vectors in space, or pairs
        return std::ranges::equal(
            a, b, {}, [](const T& v) { return std::bit_cast<Bits>(v); },
            [](const T& v) { return std::bit_cast<Bits>(v); });
    }
    static bool sameBits(const geometry::TetMesh& a, const geometry::TetMesh& b)
    {
        return a.tetrahedra == b.tetrahedra && a.labels == b.labels && sameBits(a.nodes, b.nodes);
    }
    static bool sameBits(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b)
    {
        return a.triangles == b.triangles && sameBits(a.vertices, b.vertices) && sameBits(a.uv, b.uv);
    }
    template <class T> std::size_t numberOf(const T& mesh)
    {
        if (!mesh) fail("a recording cannot hold a body without a mesh");
        for (std::size_t i = 0; i < meshes_.size(); ++i)
            if (const auto* other = std::get_if<T>(&meshes_[i]); other && (*other == mesh || sameBits(**other, *mesh)))
                return i;
        meshes_.push_back(mesh);
        return meshes_.size() - 1;
    }

    std::vector<Mesh> meshes_;
    std::size_t handedOut_ = 0;
};

} // namespace filasofia::record
