#include "filasofia/visual/material_package.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace filasofia::visual {
namespace {

using Kind = MaterialPackage::Kind;

constexpr std::uint32_t kVersion = 10;                          // filament::MATERIAL_VERSION of 1.9.25
constexpr std::uint8_t kDesktop = 2;                            // filament::backend::ShaderModel
constexpr std::uint32_t kUv0 = 1U << 3U;                        // filament::VertexAttribute, as bits
constexpr std::uint32_t kAttributes = 0x7U | kUv0 | (1U << 8U); // position, tangents, color, uv0, custom0
constexpr std::uintmax_t kMaxPackage = 64U << 20U;              // [byte]; an ordinary package has less than 1 MiB

/// Reads little-endian numbers and texts from a span; a read beyond its end is an Error.
class Reader {
public:
    Reader(std::span<const std::uint8_t> bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    template <class Number> Number number()
    {
        Number value = 0;
        const auto from = take(sizeof(Number));
        for (std::size_t i = sizeof(Number); i-- > 0;) value = Number((std::uint64_t(value) << 8U) | from[i]);
        return value;
    }

    std::string text()
    {
        const auto end = std::find(bytes_.begin(), bytes_.end(), 0);
        if (end == bytes_.end()) damaged();
        const auto from = take(std::size_t(end - bytes_.begin()) + 1);
        return {reinterpret_cast<const char*>(from.data()), from.size() - 1};
    }

    std::span<const std::uint8_t> take(std::size_t count)
    {
        if (count > bytes_.size()) damaged();
        const auto taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }

    [[nodiscard]] bool empty() const { return bytes_.empty(); }
    [[noreturn]] void damaged() const { fail("material file '", file_, "': is damaged or cut short"); }

private:
    std::span<const std::uint8_t> bytes_;
    const std::string& file_;
};

/// A package is a sequence of chunks: eight letters (backwards), a size, the content.
using Chunks = std::map<std::string, std::span<const std::uint8_t>>;

Chunks chunksOf(std::span<const std::uint8_t> bytes, const std::string& file)
{
    Chunks chunks;
    Reader in(bytes, file);
    while (!in.empty()) {
        const auto letters = in.take(8);
        const std::string name(letters.rbegin(), letters.rend());
        if (chunks.empty() && name != "MAT_VERS") fail("material file '", file, "': is not a compiled material");
        chunks[name] = in.take(in.number<std::uint32_t>());
    }
    if (chunks.empty()) fail("material file '", file, "': is empty");
    return chunks;
}

Kind kindOf(std::uint8_t type, std::uint64_t count)
{
    if (count != 1) return Kind::Other;
    switch (type) { // filament::backend::UniformType
    case 0:
        return Kind::Bool;
    case 4:
        return Kind::Float;
    case 6:
        return Kind::Float3;
    case 7:
        return Kind::Float4;
    case 8:
        return Kind::Int;
    default:
        return Kind::Other;
    }
}

void readUniforms(Reader in, std::vector<MaterialPackage::Parameter>& out)
{
    in.text();
    for (auto left = in.number<std::uint64_t>(); left > 0; --left) {
        std::string name = in.text();
        const auto count = in.number<std::uint64_t>();
        const auto type = in.number<std::uint8_t>();
        in.number<std::uint8_t>(); // precision
        out.push_back({std::move(name), kindOf(type, count)});
    }
}

/// Every sampler must get a texture, so samplers of other types are refused.
void readSamplers(Reader in, const std::string& file, std::vector<MaterialPackage::Parameter>& out)
{
    in.text();
    for (auto left = in.number<std::uint64_t>(); left > 0; --left) {
        std::string name = in.text();
        const auto type = in.number<std::uint8_t>();
        const auto format = in.number<std::uint8_t>();
        in.take(2); // precision, multisampled
        constexpr std::uint8_t kFlat = 0, kFloat = 2;
        if (type != kFlat || format != kFloat)
            fail("material file '", file, "': parameter '", name, "' must be a plain sampler2d");
        out.push_back({std::move(name), Kind::Sampler});
    }
}

/// Shaders are lists of lines of a dictionary: every list must lie in its chunk and every line in the dictionary.
void checkShaders(std::span<const std::uint8_t> dictionary, std::span<const std::uint8_t> shaders,
                  const std::string& file)
{
    Reader lines(dictionary, file);
    const auto lineCount = lines.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < lineCount; ++i) lines.text();

    Reader table(shaders, file);
    bool desktop = false;
    for (auto left = table.number<std::uint64_t>(); left > 0; --left) {
        desktop = table.number<std::uint8_t>() == kDesktop || desktop;
        table.take(2); // variant, stage
        const auto offset = table.number<std::uint32_t>();
        Reader shader(shaders, file);
        shader.take(offset);
        shader.number<std::uint32_t>(); // total number of characters
        for (auto listed = shader.number<std::uint32_t>(); listed > 0; --listed)
            if (shader.number<std::uint16_t>() >= lineCount) shader.damaged();
    }
    if (!desktop) fail("material file '", file, "': is not compiled for desktop OpenGL (matc -p desktop -a opengl)");
}

} // namespace

const MaterialPackage::Parameter* MaterialPackage::find(const std::string& name) const
{
    const auto found =
        std::find_if(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; });
    return found == parameters.end() ? nullptr : &*found;
}

const char* nameOf(Kind kind)
{
    constexpr const char* kNames[] = {"float", "float3", "float4", "int", "bool", "sampler2d", "another type"};
    return kNames[static_cast<std::size_t>(kind)];
}

MaterialPackage parseMaterialPackage(std::span<const std::uint8_t> bytes, const std::string& file)
{
    const Chunks chunks = chunksOf(bytes, file);
    const auto chunk = [&](const char* name) {
        const auto found = chunks.find(name);
        return Reader(found == chunks.end() ? std::span<const std::uint8_t>{} : found->second, file);
    };
    if (const auto version = chunk("MAT_VERS").number<std::uint32_t>(); version != kVersion)
        fail("material file '", file, "': must be of material version ", kVersion, " (matc of Filament 1.9), got ",
             version);
    if (chunk("MAT_DOMN").number<std::uint8_t>() != 0)
        fail("material file '", file, "': must be of the surface domain, not a post-process material");
    if (!chunks.contains("MAT_GLSL") || !chunks.contains("DIC_TEXT"))
        fail("material file '", file, "': is not compiled for desktop OpenGL (matc -p desktop -a opengl)");
    chunk("MAT_NAME").text();
    // One byte each: shading, blending, transparency, culling, vertex domain, interpolation, refraction and its type.
    constexpr std::pair<const char*, int> kChoices[] = {{"MAT_SHAD", 4}, {"MAT_BLEN", 6}, {"MAT_TRMD", 2},
                                                        {"MAT_CUMO", 3}, {"MAT_VEDO", 3}, {"MAT_INTR", 1},
                                                        {"MAT_REFM", 2}, {"MAT_REFT", 1}};
    for (const auto& [name, last] : kChoices)
        if (Reader choice = chunk(name); choice.number<std::uint8_t>() > last) choice.damaged();
    checkShaders(chunks.at("DIC_TEXT"), chunks.at("MAT_GLSL"), file);

    MaterialPackage package;
    readUniforms(chunk("MAT_UIB "), package.parameters);
    readSamplers(chunk("MAT_SIB "), file, package.parameters);
    const auto attributes = chunk("MAT_REQA").number<std::uint32_t>();
    if ((attributes & ~kAttributes) != 0)
        fail("material file '", file,
             "': requires a vertex attribute that bodies do not have; they have position, "
             "tangents, color, uv0 and custom0");
    package.readsUv = (attributes & kUv0) != 0;
    package.bytes.assign(bytes.begin(), bytes.end());
    return package;
}

MaterialPackage readMaterialPackage(const std::string& file)
{
    const std::string bytes = readFile(file, text("material file '", file, "'"), kMaxPackage);
    return parseMaterialPackage({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, file);
}

} // namespace filasofia::visual
