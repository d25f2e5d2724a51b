#pragma once

#include "filasofia/core/fields.h"

#include <string>
#include <variant>

namespace filasofia::visual {

/// No texture: the material's own colour.
struct NoTexture {
    friend constexpr bool operator==(const NoTexture&, const NoTexture&) = default;
};

constexpr auto fields(const NoTexture*) { return describe("NoTexture"); }

/// A PNG or JPEG of at most 8192 pixels per side, sRGB encoded. Read once per server, when it is first named.
struct TextureFile {
    std::string file = {};

    friend bool operator==(const TextureFile&, const TextureFile&) = default;
};

constexpr auto fields(const TextureFile*)
{
    return describe("TextureFile", field("file", &TextureFile::file, "a PNG or JPEG file"));
}

/// The picture of an off-screen view, as it was last drawn; black after that view is removed.
struct ViewPicture {
    std::string view = {}; ///< name of an off-screen view of the same server

    friend bool operator==(const ViewPicture&, const ViewPicture&) = default;
};

constexpr auto fields(const ViewPicture*)
{
    return describe("ViewPicture", field("view", &ViewPicture::view, "name of an off-screen view"));
}

/// A texture mapped by the uv of the surface's mesh, which must have them.
using Texture = std::variant<NoTexture, TextureFile, ViewPicture>;

} // namespace filasofia::visual
