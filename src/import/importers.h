// Mesh files. One mesh each, polygons split into triangles, numbers in double.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

struct ImportedMesh {
    Mesh mesh;                        // mesh.materials index `materials` below (empty if the file names none)
    std::vector<Material> materials;  // from the file, in order of first definition
    std::vector<Texture> textures;    // that the materials index
    std::vector<std::string> warnings;
};

// By its extension, whether importMesh reads it; and what it says if not.
bool isMeshFile(const std::filesystem::path& path);
inline constexpr const char* kNoMeshFile = "a mesh file must end in .obj, .ply, .stl, .gltf or .glb";

// Reads .obj (with its .mtl), .ply (ascii, binary little and big endian), .stl (ascii, binary) or the meshes
// of .gltf and .glb, by extension.
//
// glTF: all meshes of the default scene as one, where their nodes place them; cameras and lights are left
// out.
//
// STL: equal vertices become one; stored normals are not used.
//
// OBJ: v (with linear r g b), vn, vt, f with positive and negative indices; o, g and all else are ignored.
// MTL: Ka Kd Ks Ns illum (illum 3 and above: Ks is the mirror colour too; illum 0: Kd alone; Ka missing or
// black: the diffuse colour), map_Kd map_Ks map_Ka map_d; transparency (d, Tr), other maps and maps that
// cannot be read are warned about.
//
// PLY: x y z, nx ny nz, texture coordinates (u v, s t, texture_u texture_v), colours (red green blue:
// integers are sRGB codes, floats linear), face lists under either customary name; other elements and
// properties are skipped.
//
// Vertices that are not finite are kept (see validateScene). Throws Error(Scene), e.g.
// "bunny.obj:88: face uses vertex 9, the file has 8".
// The first form reads what lies in the model's folder.
ImportedMesh importMesh(const std::filesystem::path& path);
ImportedMesh importMesh(const std::filesystem::path& path, SceneFiles& files);

}  // namespace glint
