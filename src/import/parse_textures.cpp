#include <cmath>

#include "core/error.h"
#include "import/parse_scene.h"
#include "import/scene_keys.h"

namespace glint {

namespace {

glm::dvec2 pair(const JsonCursor& value, const char* wanted) {
    const std::vector<double> numbers = value.numbers(2, wanted);
    return {numbers[0], numbers[1]};
}

// A number for both directions, or one for each.
glm::dvec2 readScale(const JsonCursor& source) {
    const auto scale = source.find("scale");
    if (!scale) return glm::dvec2(1);
    const double* both = scale->value().number();
    const glm::dvec2 result = both ? glm::dvec2(*both) : pair(*scale, "a number or [u, v]");
    if (!std::isfinite(result.x) || !std::isfinite(result.y) || result.x == 0 || result.y == 0)
        scale->failWanted("must be finite and not 0");
    return result;
}

glm::dvec2 readOffset(const JsonCursor& source) {
    const auto offset = source.find("offset");
    return offset ? pair(*offset, "two numbers [u, v]") : glm::dvec2(0);
}

void readWrap(const JsonCursor& source, ImageTexture& image) {
    const auto wrap = source.find("wrap");
    if (!wrap) return;
    if (!wrap->value().array()) {
        image.wrapU = image.wrapV = readNamed<Wrap>(*wrap);
        return;
    }
    wrap->expectItems(2, "a wrap mode, or two of them [u, v]");
    image.wrapU = readNamed<Wrap>(wrap->item(0));
    image.wrapV = readNamed<Wrap>(wrap->item(1));
}

TexelFilter readFilter(const JsonCursor& source) {
    const auto filter = source.find("filter");
    return filter ? readNamed<TexelFilter>(*filter) : TexelFilter::Bilinear;
}

}  // namespace

std::shared_ptr<const Image> TextureParser::load(const JsonCursor& file) {
    const std::string& name = file.string();
    try {
        return files_.image(files_.resolve(folder_, name));
    } catch (const Error& e) {
        file.fail(e.what());
    }
}

Texture TextureParser::parseImage(const JsonCursor& source) {
    source.expectKeys(keys::of("imageTexture"));
    ImageTexture image;
    const JsonCursor file = source.require("texture");
    image.file = file.string();
    image.image = load(file);
    readWrap(source, image);
    image.filter = readFilter(source);
    return {std::move(image), readScale(source), readOffset(source)};
}

Texture TextureParser::parseChecker(const JsonCursor& source) {
    source.expectKeys(keys::of("checkerTexture"));
    CheckerTexture checker;
    const JsonCursor colors = source.require("checker");
    colors.expectItems(2, "two colours [a, b]");
    checker.a = colors.item(0).color();
    checker.b = colors.item(1).color();
    if (const auto solid = source.find("solid")) checker.solid = solid->boolean();
    const auto corner = source.find("corner");
    if (corner && !checker.solid)
        corner->fail("belongs to a solid checker; give \"solid\": true or \"offset\"");
    if (corner) checker.corner = corner->vector3();
    if (const auto offset = source.find("offset"); offset && checker.solid)
        offset->fail("a solid checker is moved by \"corner\": [x, y, z]");
    if (const auto scale = source.find("scale"); scale && checker.solid && !scale->value().number())
        scale->failWanted("must be a number for a solid checker");
    return {checker, readScale(source), readOffset(source)};
}

void TextureParser::readColor(const JsonCursor& object, std::string_view key, Color& color,
                              uint32_t& texture) {
    const auto found = object.find(key);
    if (!found) return;
    texture = Material::kNoTexture;
    if (const std::string* file = found->value().string())
        found->fail("a texture is written as {\"texture\": \"" + *file + "\"}");
    if (!found->value().object()) {
        color = found->color();
        return;
    }
    const bool checker = found->find("checker").has_value();
    if (!checker && !found->find("texture"))
        found->fail("must hold \"texture\": \"FILE\" or \"checker\": [a, b], or be a number or [r, g, b]");
    Texture parsed = checker ? parseChecker(*found) : parseImage(*found);
    color = Color(1);
    if (const auto tint = found->find("color")) color = tint->color();
    texture = static_cast<uint32_t>(scene_.textures.size());
    scene_.textures.push_back(std::move(parsed));
}

void TextureParser::readBackground(const JsonCursor& root) {
    const auto background = root.find("background");
    if (!background) return;
    if (!background->value().object()) {
        scene_.background = background->color();
        return;
    }
    background->expectKeys(keys::of("environmentMap"));
    EnvironmentMap map;
    const JsonCursor file = background->require("environment");
    map.file = file.string();
    map.image = load(file);
    if (const auto rotation = background->find("rotation")) map.rotation = rotation->number();
    if (const auto intensity = background->find("intensity")) map.intensity = intensity->color();
    scene_.environment = std::move(map);
}

}  // namespace glint
