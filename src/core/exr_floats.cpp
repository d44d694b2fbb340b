// By OpenEXRCore. The older library puts each float together from four bytes on the stack, which takes nine
// tenths of the time of a file that is not compressed; this one copies rows (docs/lab/file-readers.md). It
// has no DWA and takes longer for PIZ, and halves gain little, so those stay with the other.
#include "core/exr_floats.h"

#include <openexr.h>

#include <algorithm>
#include <cstring>

namespace glint {
namespace {

int64_t readBytes(exr_const_context_t context, void* file, void* bytes, uint64_t count, uint64_t offset,
                  exr_stream_error_func_ptr_t) {
    static_cast<void>(context);
    const ByteView& view = *static_cast<const ByteView*>(file);
    if (offset > view.size()) return -1;
    const uint64_t there = std::min<uint64_t>(count, view.size() - offset);
    std::memcpy(bytes, view.data() + offset, there);
    return static_cast<int64_t>(there);
}

int64_t sizeOfFile(exr_const_context_t, void* file) {
    return static_cast<int64_t>(static_cast<const ByteView*>(file)->size());
}

// A context and its decoder, closed in any case. Nothing is printed.
class Reader {
  public:
    explicit Reader(ByteView file) : file_(file) {
        exr_context_initializer_t options{};
        options.size = sizeof(options);
        options.user_data = &file_;
        options.read_fn = readBytes;
        options.size_fn = sizeOfFile;
        options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
        open_ = exr_start_read(&context_, "the file", &options) == EXR_ERR_SUCCESS;
    }
    ~Reader() {
        if (begun_) exr_decoding_destroy(context_, &decoder_);
        exr_finish(&context_);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    bool isOpen() const { return open_; }
    exr_const_context_t context() const { return context_; }
    // Makes ready for the chunk that begins with row y.
    bool begin(int y, exr_chunk_info_t& chunk) {
        if (exr_read_scanline_chunk_info(context_, 0, y, &chunk) != EXR_ERR_SUCCESS) return false;
        const exr_result_t result = begun_ ? exr_decoding_update(context_, 0, &chunk, &decoder_)
                                           : exr_decoding_initialize(context_, 0, &chunk, &decoder_);
        fresh_ = !begun_;
        begun_ = begun_ || result == EXR_ERR_SUCCESS;
        return result == EXR_ERR_SUCCESS;
    }
    // Sends channels[c] of the chunk to `first` + c, interleaved. False if a channel is missing.
    bool into(float* first, size_t rowSamples, const std::vector<std::string>& channels) {
        const size_t count = channels.size();
        size_t found = 0;
        for (int i = 0; i < decoder_.channel_count; ++i) {
            exr_coding_channel_info_t& channel = decoder_.channels[i];
            const auto name = std::find(channels.begin(), channels.end(), channel.channel_name);
            channel.decode_to_ptr = nullptr;
            if (name == channels.end() || channel.data_type != EXR_PIXEL_FLOAT) continue;
            ++found;
            channel.decode_to_ptr = reinterpret_cast<uint8_t*>(first + (name - channels.begin()));
            channel.user_pixel_stride = static_cast<int32_t>(count * sizeof(float));
            channel.user_line_stride = static_cast<int32_t>(rowSamples * sizeof(float));
            channel.user_bytes_per_element = sizeof(float);
            channel.user_data_type = EXR_PIXEL_FLOAT;
        }
        return found == count;
    }
    bool run() {
        if (fresh_ && exr_decoding_choose_default_routines(context_, 0, &decoder_) != EXR_ERR_SUCCESS)
            return false;
        return exr_decoding_run(context_, 0, &decoder_) == EXR_ERR_SUCCESS;
    }

  private:
    ByteView file_;
    exr_context_t context_ = nullptr;
    exr_decode_pipeline_t decoder_{};
    bool open_ = false, begun_ = false, fresh_ = false;
};

// The row that the file begins with, if it is of that shape.
std::optional<int> firstRow(exr_const_context_t context, const ExrShape& shape) {
    int parts = 0;
    exr_storage_t storage{};
    exr_compression_t compression{};
    exr_attr_box2i_t window{};
    const exr_attr_chlist_t* list = nullptr;
    const bool known = exr_get_count(context, &parts) == EXR_ERR_SUCCESS &&
                       exr_get_storage(context, 0, &storage) == EXR_ERR_SUCCESS &&
                       exr_get_compression(context, 0, &compression) == EXR_ERR_SUCCESS &&
                       exr_get_data_window(context, 0, &window) == EXR_ERR_SUCCESS &&
                       exr_get_channels(context, 0, &list) == EXR_ERR_SUCCESS;
    const bool packed = compression == EXR_COMPRESSION_NONE || compression == EXR_COMPRESSION_RLE ||
                        compression == EXR_COMPRESSION_ZIPS || compression == EXR_COMPRESSION_ZIP;
    const bool same = known && static_cast<int>(compression) == shape.compression &&
                      list->num_channels == shape.channels &&
                      int64_t{window.max.x} - window.min.x + 1 == shape.width &&
                      int64_t{window.max.y} - window.min.y + 1 == shape.height;
    if (!same || !packed || parts != 1 || storage != EXR_STORAGE_SCANLINE) return std::nullopt;
    return window.min.y;
}

}  // namespace

std::optional<Image> readExrFloats(ByteView file, const ExrShape& shape,
                                   const std::vector<std::string>& channels, const Context& context) {
    Reader reader(file);
    const std::optional<int> first = reader.isOpen() ? firstRow(reader.context(), shape) : std::nullopt;
    if (!first) return std::nullopt;
    RowCollector rows(context, shape.width, shape.height, static_cast<int>(channels.size()));
    const size_t rowSamples = static_cast<size_t>(shape.width) * channels.size();
    for (int y = 0; y < shape.height;) {
        exr_chunk_info_t chunk{};
        if (!reader.begin(*first + y, chunk) || chunk.start_y != *first + y || chunk.height <= 0 ||
            chunk.height > shape.height - y)
            return std::nullopt;
        if (!reader.into(rows.next(chunk.height), rowSamples, channels) || !reader.run()) return std::nullopt;
        y += chunk.height;
    }
    return rows.take();
}

}  // namespace glint
