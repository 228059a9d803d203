// SPDX-License-Identifier: MIT OR Apache-2.0
//
// An adapter (../../PROTOCOL.md) in C++17, as small as is useful: the commands decode, prefix and lod. It shows how a decoder
// written in C++ is connected; here the C readers of ../../ports/c take its place. What is to be replaced are the functions
// show_grid and show_mesh, which take the bytes of a file, and return a verdict and what OUT holds.
//
//     c++ -std=c++17 -O2 -Wall -Wextra -I../../ports/c adapter.cpp -o adapter -lm

#define IVG_IMPLEMENTATION
#define PMESH_IMPLEMENTATION
#include "ivg.h"
#include "pmesh.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

using Bytes = std::vector<uint8_t>;

// What OUT holds: all numbers little-endian, one after the other.
class Output {
public:
    void u8(unsigned number) { bytes_.push_back(static_cast<uint8_t>(number)); }
    void u16(unsigned number) { put(number, 2); }
    void u32(uint32_t number) { put(number, 4); }
    void f32(float number) { u32(bits<uint32_t>(number)); }
    void f64(double number) { put(bits<uint64_t>(number), 8); }
    void text(const uint8_t *bytes, size_t length) { bytes_.insert(bytes_.end(), bytes, bytes + length); }
    void named(const uint8_t *bytes, size_t length) { u32(static_cast<uint32_t>(length)), text(bytes, length); }
    void fill(uint8_t byte, uint64_t count) { bytes_.insert(bytes_.end(), static_cast<size_t>(count), byte); }
    const Bytes &bytes() const { return bytes_; }

private:
    template <class Bits, class Number> static Bits bits(Number number)
    {
        static_assert(sizeof(Bits) == sizeof(Number), "the same size");
        Bits result;
        std::memcpy(&result, &number, sizeof result);
        return result;
    }
    void put(uint64_t number, int length)
    {
        for (int i = 0; i < length; i++) bytes_.push_back(static_cast<uint8_t>(number >> (8 * i)));
    }
    Bytes bytes_;
};

constexpr uint32_t absent = 0xFFFFFFFF;

bool is_shown(const frame_result &result) { return result.verdict == FRAME_OK || result.verdict == FRAME_NEED_MORE; }

frame_result show_grid(const Bytes &file, Output &out)
{
    struct Vertex {
        ivg_record record;
        uint32_t number;
    };
    ivg_reader reader;
    ivg_event event, lights{}, metadata{};
    std::vector<ivg_record> validity;
    std::map<uint64_t, Vertex> vertices; // by linear index
    bool has_header = false;
    ivg_start(&reader, nullptr);
    while ((event = ivg_next(&reader, file.data(), file.size())).kind != IVG_STOP) {
        if (event.kind == IVG_HEADER) has_header = true;
        if (event.kind == IVG_LIGHTS) lights = event;
        if (event.kind == IVG_METADATA) metadata = event;
        if (event.kind != IVG_RECORD) continue;
        if (event.record.kind == IVG_VALIDITY) validity.push_back(event.record);
        ivg_vertices next;
        ivg_first_vertex(&next, &reader.header, &event.record);
        while (ivg_next_vertex(&next)) vertices[next.linear_index] = {event.record, next.number};
    }
    if (!is_shown(event.result) || !has_header) return event.result;

    const ivg_header &header = reader.header;
    const uint64_t count = ivg_vertex_count(&header);
    for (uint16_t n : header.dims) out.u32(n);
    for (double x : header.origin) out.f64(x);
    for (double x : header.step) out.f64(x);
    out.u32(header.units);
    out.u32(header.encoding == IVG_SH2_28);
    out.u32(lights.payload != nullptr ? frame_u32(lights.payload) : absent);
    ivg_named_light light;
    for (uint64_t at = 0; ivg_next_named_light(lights.payload, lights.payload_bytes, &at, &light);) {
        out.u32(static_cast<uint32_t>(light.direct));
        out.named(light.name, light.name_bytes);
    }
    if (metadata.payload != nullptr) {
        out.named(metadata.payload, static_cast<size_t>(metadata.payload_bytes));
    } else {
        out.u32(absent);
    }
    uint64_t end = 0; // of what is written so far
    for (const auto &[index, vertex] : vertices) {
        out.fill(0, index - end);
        out.fill(1, 1);
        end = index + 1;
    }
    out.fill(0, count - end);
    end = 0;
    for (const ivg_record &record : validity) {
        for (uint32_t i = 0; i < record.vertices; i++) out.u8(ivg_validity(&record, i));
        end += record.vertices;
    }
    out.fill(255, count - end);
    for (const ivg_record &record : validity) {
        for (uint32_t i = 0; i < record.vertices; i++) out.u8(ivg_blocked_edges(&record, i));
    }
    out.fill(0, count - end);
    std::vector<float> values(ivg_values_per_vertex(&header));
    for (const auto &[index, vertex] : vertices) {
        ivg_values(&header, &vertex.record, vertex.number, values.data());
        for (float value : values) out.f32(value);
    }
    return event.result;
}

// Level n or, without one, the finest that is complete.
frame_result show_mesh(const Bytes &file, std::optional<uint32_t> n, Output &out)
{
    pmesh_reader reader;
    pmesh_event event, names{};
    std::vector<uint64_t> memory, larger; // aligned to 8 bytes
    bool has_header = false;
    pmesh_start(&reader, nullptr);
    while ((event = pmesh_next(&reader, file.data(), file.size())).kind != PMESH_STOP) {
        if (event.kind == PMESH_HEADER) has_header = true;
        if (event.kind == PMESH_MATERIAL_LIST) names = event;
        if (event.kind != PMESH_MEMORY) continue;
        larger = std::vector<uint64_t>(static_cast<size_t>(event.memory_bytes / 8 + 1));
        if (!pmesh_give_memory(&reader, larger.data(), event.memory_bytes)) throw std::runtime_error("memory");
        memory.swap(larger);
    }
    if (!is_shown(event.result) || !has_header) return event.result;

    const pmesh_header &header = reader.header;
    for (double x : header.origin) out.f64(x);
    out.u32(header.attributes);
    for (uint32_t x : {header.vertex_count, header.wedge_count, header.face_count, header.base_vertices}) out.u32(x);
    out.u32(header.packet_count);
    out.text(file.data() + reader.directory_offset, 20 * static_cast<size_t>(header.packet_count)); // as it is stored
    uint64_t at = 0;
    uint32_t count = 0;
    const uint8_t *name;
    uint16_t length;
    while (pmesh_next_material(names.payload, names.payload_bytes, &at, &name, &length)) count++;
    out.u32(names.payload != nullptr ? count : absent);
    for (at = 0; pmesh_next_material(names.payload, names.payload_bytes, &at, &name, &length);) out.named(name, length);

    const uint32_t level = n.value_or(pmesh_finest_level(&reader));
    pmesh_level_counts counts;
    if (!pmesh_level(&reader, level, &counts)) {
        out.u32(PMESH_NO_LEVEL);
        return event.result;
    }
    for (uint32_t x : {level, counts.vertices, counts.wedges, counts.faces}) out.u32(x);
    const size_t v = counts.vertices, w = counts.wedges, f = counts.faces;
    const pmesh_mesh &mesh = reader.mesh;
    std::vector<uint32_t> corners(3 * f);
    pmesh_corners(&reader, level, corners.data());
    for (size_t i = 0; i < 3 * v; i++) out.f32(mesh.positions[i]);
    for (size_t i = 0; i < w; i++) out.u32(mesh.wedge_vertex[i]);
    for (size_t i = 0; mesh.normals != nullptr && i < 3 * w; i++) out.f32(mesh.normals[i]);
    for (size_t i = 0; mesh.uvs != nullptr && i < 2 * w; i++) out.f32(mesh.uvs[i]);
    for (size_t i = 0; mesh.colours != nullptr && i < 4 * w; i++) out.u8(mesh.colours[i]);
    for (uint32_t corner : corners) out.u32(corner);
    for (size_t i = 0; mesh.materials != nullptr && i < f; i++) out.u16(mesh.materials[i]);
    return event.result;
}

int run(const std::vector<std::string> &words)
{
    if (words == std::vector<std::string>{"capabilities"}) {
        std::cout << "name ivg.h and pmesh.h from C++\nivg decode prefix\npmesh decode prefix lod\ncodes\n";
        return 0;
    }
    const bool is_decode = words.size() == 4 && words[0] == "decode";
    if (!is_decode && !(words.size() == 5 && (words[0] == "prefix" || words[0] == "lod"))) {
        throw std::runtime_error("see conformance/PROTOCOL.md");
    }
    std::ifstream in(words[2], std::ios::binary);
    if (!in) throw std::runtime_error("the input cannot be opened");
    Bytes file{std::istreambuf_iterator<char>(in), {}};
    std::optional<uint32_t> level;
    if (words[0] == "prefix") file.resize(std::min<size_t>(file.size(), std::stoul(words[4])));
    if (words[0] == "lod") level = static_cast<uint32_t>(std::stoul(words[4]));

    Output out;
    const frame_result result = words[1] == "ivg" ? show_grid(file, out) : show_mesh(file, level, out);
    std::ofstream to(words[3], std::ios::binary);
    to.write(reinterpret_cast<const char *>(out.bytes().data()), static_cast<std::streamsize>(out.bytes().size()));
    if (!to.flush()) throw std::runtime_error("the output cannot be written");
    if (!is_shown(result)) std::cout << result.code << ' ' << result.offset << '\n';
    return result.verdict;
}

int main(int argc, char **argv)
{
    try {
        return run({argv + 1, argv + argc});
    } catch (const std::exception &error) {
        std::cerr << "adapter: " << error.what() << '\n';
        return 1; // no verdict
    }
}
