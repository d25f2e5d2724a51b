#include "filasofia/visual/material_store.h"

#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/material_overrides.h"

#include <cmath>

namespace filasofia::visual {
namespace {

using Kind = MaterialPackage::Kind;

Kind kindOf(const ParameterValue& value)
{
    struct Visitor {
        Kind operator()(double) const { return Kind::Float; }
        Kind operator()(int) const { return Kind::Int; }
        Kind operator()(bool) const { return Kind::Bool; }
        Kind operator()(const Color&) const { return Kind::Float3; }
        Kind operator()(const Vec3&) const { return Kind::Float3; }
        Kind operator()(const std::array<double, 4>&) const { return Kind::Float4; }
        Kind operator()(const Texture&) const { return Kind::Sampler; }
    };
    return std::visit(Visitor{}, value);
}

bool fitsFloat(const ParameterValue& value)
{
    constexpr double kMaxFloat = 3.4e38; // a larger double is infinite as a float
    const auto fits = [](double number) { return std::abs(number) < kMaxFloat; };
    if (const auto* number = std::get_if<double>(&value)) return fits(*number);
    if (const auto* three = std::get_if<Vec3>(&value)) return fits(three->x) && fits(three->y) && fits(three->z);
    if (const auto* four = std::get_if<std::array<double, 4>>(&value))
        return fits((*four)[0]) && fits((*four)[1]) && fits((*four)[2]) && fits((*four)[3]);
    return true;
}

/// Whether a picture holds slopes: all but one pixel in a hundred point out of the surface. (Lossy files have a few
/// that do not; a height map or a photograph has many.)
bool holdsNormals(const Image& image)
{
    constexpr std::uint8_t kLevel = 128;
    std::size_t inwards = 0;
    for (std::size_t blue = 2; blue < image.rgba.size(); blue += 4) inwards += image.rgba[blue] < kLevel;
    return 400 * inwards <= image.rgba.size();
}

} // namespace

ReadyMaterial MaterialStore::ready(const Material& material, const std::string& object)
{
    if (const auto* named = std::get_if<NamedMaterial>(&material))
        return ready(get(named->name, object), *named, object);
    std::visit([&](const auto& held) { validate(held, object); }, material);
    if (const auto* glass = std::get_if<GlassMaterial>(&material))
        for (double share : {glass->tint.red, glass->tint.green, glass->tint.blue})
            if (share <= 0.0) fail(object, ": tint must be > 0 in every colour, got ", share);
    ReadyMaterial out;
    out.material = material;
    std::visit([&](const auto& held) { requireTextures(held, object, out); }, material);
    return out;
}

ReadyMaterial MaterialStore::ready(const Material& pool, const NamedMaterial& named, const std::string& object)
{
    const std::string whole = text(object, " '", named.name, "'");
    const auto* custom = std::get_if<CustomMaterial>(&pool);
    const auto read = custom ? package(*custom, whole) : nullptr;
    return ready(overridden(pool, named.overrides, read.get(), whole), whole);
}

template <class Held>
void MaterialStore::requireTextures(const Held& material, const std::string& object, ReadyMaterial& out)
{
    if constexpr (std::is_same_v<Held, CustomMaterial>) {
        require(material, object, out);
    } else {
        forEachField<Held>([&](const auto& each) {
            using Value = std::remove_cvref_t<decltype(material.*(each.member))>;
            if constexpr (std::is_same_v<Value, Texture> || std::is_same_v<Value, TextureMap>)
                require(material.*(each.member), object, each.name, out);
        });
        if constexpr (requires { material.normalTexture; }) requireNormals(material.normalTexture, object, out);
    }
}

void MaterialStore::requirePicture(const std::string& file, const std::string& object, ReadyMaterial& out)
{
    std::shared_ptr<const Image>& kept = pictures_[file];
    try {
        if (!kept) kept = std::make_shared<const Image>(loadImage(file));
    } catch (const Error& error) {
        fail(object, ": ", error.what());
    }
    out.pictures[file] = kept;
}

void MaterialStore::require(const Texture& texture, const std::string& object, std::string_view field,
                            ReadyMaterial& out)
{
    if (const auto* view = std::get_if<ViewPicture>(&texture)) out.views.push_back(view->view);
    if (const auto* picture = std::get_if<TextureFile>(&texture))
        requirePicture(picture->file, text(object, ": ", field), out);
    if (out.needsUv.empty() && !std::holds_alternative<NoTexture>(texture)) out.needsUv = field;
}

void MaterialStore::require(const TextureMap& map, const std::string& object, std::string_view field,
                            ReadyMaterial& out)
{
    if (const auto* picture = std::get_if<TextureFile>(&map)) require(Texture(*picture), object, field, out);
}

void MaterialStore::requireNormals(const TextureMap& map, const std::string& object, ReadyMaterial& out)
{
    const auto* picture = std::get_if<TextureFile>(&map);
    if (!picture) return;
    out.needsTangents = true;
    if (normalMaps_.contains(picture->file)) return;
    if (!holdsNormals(*out.pictures.at(picture->file)))
        fail(object, ": normalTexture: picture '", picture->file,
             "': is no normal map: blue must be >= 128, but is less in more than one pixel of a hundred");
    normalMaps_.insert(picture->file);
}

std::shared_ptr<const MaterialPackage> MaterialStore::package(const CustomMaterial& material, const std::string& object)
{
    std::shared_ptr<const MaterialPackage>& kept = packages_[material.file];
    try {
        if (!kept) kept = std::make_shared<const MaterialPackage>(readMaterialPackage(material.file));
    } catch (const Error& error) {
        fail(object, ": ", error.what());
    }
    return kept;
}

void MaterialStore::require(const CustomMaterial& material, const std::string& object, ReadyMaterial& out)
{
    out.package = package(material, object);
    for (const MaterialParameter& given : material.parameters) {
        const std::string where = text(object, ": parameter '", given.name, "' of material file '", material.file, "'");
        const MaterialPackage::Parameter* declared = out.package->find(given.name);
        if (!declared) fail(where, ": the file has no parameter of this name");
        if (declared->kind != kindOf(given.value))
            fail(where, ": must be a ", nameOf(declared->kind), ", got a ", nameOf(kindOf(given.value)));
        if (!fitsFloat(given.value)) fail(where, ": must be finite");
        if (const auto* texture = std::get_if<Texture>(&given.value))
            require(*texture, object, text("parameter '", given.name, "' of material file '", material.file, "'"), out);
    }
    if (out.needsUv.empty() && out.package->readsUv) out.needsUv = text("material file '", material.file, "'");
    out.needsTangents = out.package->readsUv; // which may be for a normal map
}

void MaterialStore::add(const std::string& name, const Material& material)
{
    if (name.empty()) fail("a material of the pool must have a name");
    if (!named_.emplace(name, material).second) fail("material '", name, "' already exists");
}

const Material& MaterialStore::get(const std::string& name, const std::string& object) const
{
    const auto found = named_.find(name);
    if (found == named_.end()) fail(object, ": there is no material '", name, "' in the pool");
    return found->second;
}

} // namespace filasofia::visual
