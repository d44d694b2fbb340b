#include "app/ray_file.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/error.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

constexpr size_t kLongestLine = 65536;  // of a device that never ends, or a file of another kind
constexpr const char* kForm = "ox,oy,oz,dx,dy,dz[,tmin[,tmax]]";
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // what some spreadsheets start a CSV file with

double parseNumber(const std::string& field, const std::string& where) {
    const bool plus = field.size() > 1 && field[0] == '+' && field[1] != '-';
    const char* const begin = field.data() + (plus ? 1 : 0);
    const char* const end = field.data() + field.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument || stop != end) {
        throw Error(ErrorKind::Scene, where + ": expected a number, got " + quoted(field));
    }
    if (error == std::errc::result_out_of_range) {
        throw Error(ErrorKind::Scene,
                    where + ": number out of the range of double precision: " + quoted(field));
    }
    return value;
}

WorldRay parseRay(const std::string& line, const std::string& where) {
    const std::vector<std::string> fields = split(line, ',');
    if (fields.size() < 6 || fields.size() > 8) {
        throw Error(ErrorKind::Scene,
                    where + ": expected 6 to 8 numbers " + kForm + ", got " + std::to_string(fields.size()));
    }
    std::vector<double> v;
    for (const std::string& field : fields) v.push_back(parseNumber(trimmed(field), where));
    WorldRay ray;
    ray.origin = {v[0], v[1], v[2]};
    ray.direction = {v[3], v[4], v[5]};
    if (v.size() > 6) ray.tMin = v[6];
    if (v.size() > 7) ray.tMax = v[7];
    return ray;
}

}  // namespace

std::vector<WorldRay> parseRays(std::istream& in, const std::string& name) {
    std::vector<WorldRay> rays;
    std::vector<char> bytes(kLongestLine + 1);
    size_t number = 1;
    for (; in.getline(bytes.data(), static_cast<std::streamsize>(bytes.size())); ++number) {
        // The last line may have no end, which is counted else.
        std::string line(bytes.data(), static_cast<size_t>(in.gcount()) - (in.eof() ? 0 : 1));
        if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
        const std::string text = trimmed(line.substr(0, line.find('#')));
        const bool header = rays.empty() && text.starts_with("ox,");
        if (!text.empty() && !header) rays.push_back(parseRay(text, name + ":" + std::to_string(number)));
    }
    if (in.bad()) throw Error(ErrorKind::Scene, name + ": cannot read the rays");
    if (!in.eof())
        throw Error(ErrorKind::Scene, name + ":" + std::to_string(number) + ": a line of more than " +
                                          std::to_string(kLongestLine) + " bytes");
    return rays;
}

std::vector<WorldRay> readRays(const std::string& file) {
    if (file == "-") return parseRays(std::cin, "standard input");
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error(ErrorKind::Scene, file + ": is a folder, not a file of rays");
    std::ifstream stream(file);
    if (!stream) {
        const bool exists = std::filesystem::exists(file, ignored);
        throw Error(ErrorKind::Scene, file + (exists ? ": cannot read the rays" : ": no such file"));
    }
    return parseRays(stream, file);
}

}  // namespace glint::app
