#include "filasofia/visual/filament_textures.h"

#include <filament/TextureSampler.h>

namespace filasofia::visual {
namespace {

using FTexture = filament::Texture;
using Sampler = filament::TextureSampler;

FTexture* upload(filament::Engine& engine, const Image& image)
{
    FTexture* texture =
        FTexture::Builder()
            .width(std::uint32_t(image.width))
            .height(std::uint32_t(image.height))
            .levels(0xff) // all mipmap levels
            .format(FTexture::InternalFormat::SRGB8_A8)
            .usage(FTexture::Usage::DEFAULT | FTexture::Usage::COLOR_ATTACHMENT) // needed to generate mipmaps
            .build(engine);
    auto* kept = new std::vector<std::uint8_t>(image.rgba);
    texture->setImage(engine, 0,
                      FTexture::PixelBufferDescriptor(
                          kept->data(), kept->size(), FTexture::Format::RGBA, FTexture::Type::UBYTE,
                          [](void*, std::size_t, void* user) { delete static_cast<std::vector<std::uint8_t>*>(user); },
                          kept));
    if (texture->getLevels() > 1) texture->generateMipmaps(engine);
    return texture;
}

Image onePixel(std::uint8_t value) { return {1, 1, {value, value, value, 255}}; }

Sampler samplerOf(const Texture& texture)
{
    if (std::holds_alternative<ViewPicture>(texture)) return Sampler(Sampler::MagFilter::LINEAR);
    Sampler sampler(Sampler::MinFilter::LINEAR_MIPMAP_LINEAR, Sampler::MagFilter::LINEAR, Sampler::WrapMode::REPEAT);
    sampler.setAnisotropy(4.0F);
    return sampler;
}

} // namespace

TexturePool::TexturePool(filament::Engine& engine)
    : engine_(engine), white_(upload(engine, onePixel(255))), black_(upload(engine, onePixel(0)))
{
}

TexturePool::~TexturePool()
{
    engine_.destroy(white_);
    engine_.destroy(black_);
    for (const auto& [name, texture] : files_) engine_.destroy(texture);
}

void TexturePool::setView(const std::string& name, FTexture* picture)
{
    if (picture)
        views_[name] = picture;
    else
        views_.erase(name);
}

FTexture* TexturePool::file(const std::string& name, const Image& image)
{
    const auto [found, isNew] = files_.try_emplace(name, nullptr);
    if (isNew) found->second = upload(engine_, image);
    return found->second;
}

void TexturePool::apply(const Texture& texture, const ReadyMaterial& from, filament::MaterialInstance& instance,
                        const char* parameter)
{
    FTexture* shown = white_;
    if (const auto* picture = std::get_if<TextureFile>(&texture))
        shown = file(picture->file, *from.pictures.at(picture->file));
    if (const auto* view = std::get_if<ViewPicture>(&texture)) {
        const auto found = views_.find(view->view);
        shown = found == views_.end() ? black_ : found->second;
    }
    instance.setParameter(parameter, shown, samplerOf(texture));
}

void TexturePool::applyWithKind(const Texture& texture, const ReadyMaterial& from, filament::MaterialInstance& instance,
                                const char* parameter)
{
    apply(texture, from, instance, parameter);
    instance.setParameter("textured", static_cast<int>(texture.index()));
}

} // namespace filasofia::visual
