// MTL, the materials of OBJ files (Wavefront, Advanced Visualizer manual, B1), parsed by tinyobjloader.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <sstream>
#include <type_traits>

#include "core/text_file.h"
#include "import/mtl_maps.h"
#include "import/readers.h"
#include "scene/validate.h"

static_assert(std::is_same_v<tinyobj::real_t, double>, "link tinyobjloader's double build");

namespace glint {

namespace {

Color color(const double (&rgb)[3]) {
    return {rgb[0], rgb[1], rgb[2]};
}

// The maps that are named and have no use here, as the file spells them.
std::vector<const char*> ignoredMaps(const tinyobj::material_t& m) {
    const std::pair<const std::string&, const char*> maps[] = {{m.specular_highlight_texname, "map_Ns"},
                                                               {m.bump_texname, "map_bump"},
                                                               {m.displacement_texname, "disp"},
                                                               {m.reflection_texname, "refl"},
                                                               {m.roughness_texname, "map_Pr"},
                                                               {m.metallic_texname, "map_Pm"},
                                                               {m.sheen_texname, "map_Ps"},
                                                               {m.emissive_texname, "map_Ke"},
                                                               {m.normal_texname, "norm"}};
    std::vector<const char*> named;
    for (const auto& [file, key] : maps)
        if (!file.empty()) named.push_back(key);
    return named;
}

Material convert(const tinyobj::material_t& m) {
    Material material;
    material.name = m.name;
    material.diffuse = color(m.diffuse);
    // Exporters without an ambient term write Ka 0 0 0 or leave it out; taken at its word the unlit side of
    // nearly every model would be black, so both mean what a missing "ambient" means in a scene file: the
    // diffuse colour.
    const Color ambient = color(m.ambient);
    material.ambient = m.illum == 0 || ambient == Color(0) ? material.diffuse : ambient;
    material.shininess = m.shininess;
    const Color specular = m.illum == 0 ? Color(0) : color(m.specular);
    // An exponent of 0 would add Ks to every lit point; exporters mean "no highlight" by Ns 0.
    if (m.shininess > 0) material.specular = specular;
    // Illumination models from 3 up trace rays (3: mirror, 4 to 7: glass and Fresnel, 8 and 9: without rays).
    if (m.illum >= 3) material.mirror = glm::min(specular, Color(1));
    return material;
}

// What shines through: 1 - d of the light, filtered by Tf; or all of it, where the illumination model is one
// of clear things and Tf says so. Tf black stands for no Tf: the parser knows no difference, and exporters
// write both. The models 6 and 7 refract, with Fresnel's law in the place of the mirror colour; all others
// let light go straight on. What shines through is not there to reflect.
void letThrough(const tinyobj::material_t& m, Material& material) {
    const bool refracts = m.illum == 6 || m.illum == 7;
    const bool clear = refracts || m.illum == 4 || m.illum == 9;
    const Color filter = color(m.transmittance);
    const double through = 1 - std::clamp(m.dissolve, 0.0, 1.0);
    if (through > 0)
        material.transmission = through * (filter == Color(0) ? Color(1) : glm::min(filter, Color(1)));
    else if (clear)
        material.transmission = glm::min(filter, Color(1));
    if (material.transmission == Color(0)) return;
    material.ior = refracts ? m.ior : 1;
    for (Color* part : {&material.ambient, &material.diffuse, &material.specular, &material.mirror})
        *part *= 1 - through;
    if (refracts) material.mirror = Color(0);
}

}  // namespace

void readMtl(const std::filesystem::path& path, SceneFiles& files, std::vector<Material>& materials,
             std::vector<Texture>& textures, std::vector<std::string>& warnings) {
    const std::string file = path.string();
    std::istringstream stream(files.read(path));
    std::map<std::string, int> indices;
    std::vector<tinyobj::material_t> parsed;
    std::string parserWarnings, errors;
    tinyobj::LoadMtl(&indices, &parsed, &stream, &parserWarnings, &errors);

    MtlMaps maps(path, files, textures, warnings);
    std::vector<std::string> ignored;  // each map once, in order
    for (const tinyobj::material_t& m : parsed) {
        if (m.name.empty()) continue;  // what stands before the first newmtl
        for (const char* map : ignoredMaps(m))
            if (std::find(ignored.begin(), ignored.end(), map) == ignored.end()) ignored.emplace_back(map);
        if (color(m.emission) != Color(0))
            warnings.push_back(file + ": material \"" + m.name +
                               "\": Ke is ignored, surfaces that glow are not supported");
        Material material = convert(m);
        maps.apply(m, material);
        letThrough(m, material);
        validateMaterial(material, {file, "material \"" + m.name + "\""});
        materials.push_back(material);
    }
    for (const std::string& map : ignored)
        warnings.push_back(file + ": " + map + " is ignored, such maps are not supported by this version");
}

}  // namespace glint
