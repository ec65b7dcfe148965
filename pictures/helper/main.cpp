// palpate-picture-helper: draws one scene with VTK, or names the graphics that it would be drawn
// with, and reports; wire.hpp defines the format. As a separate process it lets palpate start fast
// and survive a crash of OpenGL.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

#include "io/helper/child.hpp"
#include "io/helper/library_words.hpp"
#include "io/helper/report.hpp"
#include "pictures/helper/compositor.hpp"
#include "pictures/helper/egl_context.hpp"
#include "pictures/helper/failure.hpp"
#include "pictures/wire.hpp"

namespace palpate::pictures {
namespace {

/// Complaints of VTK go to standard error and are errors here, because the picture may lack
/// anything.
class Complaints : public vtkOutputWindow {
  public:
    // As vtkStandardNewMacro has it, whose semicolons a pedantic compiler refuses.
    static Complaints* New() {
        auto* const made = new Complaints;
        made->InitializeObjectBase();
        return made;
    }
    void DisplayErrorText(const char* text) override {
        std::fputs(text, stderr);
        if (first_.empty()) first_ = text;
    }
    void DisplayText(const char* text) override { std::fputs(text, stderr); }
    const std::string& first() const { return first_; }

  private:
    std::string first_;
};

/// The shared memory, mapped until the process ends.
std::span<char> shared_memory() {
    struct stat status {};
    if (fstat(io::samples_descriptor, &status) != 0 || status.st_size < 8) {
        throw Failure("there is no scene");
    }
    const auto bytes = static_cast<std::size_t>(status.st_size);
    void* const at =
        mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, io::samples_descriptor, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    return {static_cast<char*>(at), bytes};
}

template <class T>
std::span<T> array_in(std::span<char> memory, const Extent& extent) {
    if (extent.at % array_alignment != 0 || extent.at > memory.size() ||
        extent.count > (memory.size() - extent.at) / element_bytes) {
        throw Failure("the scene's arrays lie outside of it");
    }
    return {reinterpret_cast<T*>(memory.data() + extent.at), 3 * extent.count};
}

json text_in(std::span<char> memory) {
    std::uint64_t length = 0;
    std::memcpy(&length, memory.data(), sizeof length);
    if (length > memory.size() - sizeof length) throw Failure("the scene is cut off");
    const char* const text = memory.data() + sizeof length;
    return json::parse(text, text + length);
}

/// Rows from the bottom.
std::string png_from(const std::vector<unsigned char>& pixels, int width, int height) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::memcpy(image->GetScalarPointer(), pixels.data(), pixels.size());
    vtkNew<vtkPNGWriter> writer;
    writer->WriteToMemoryOn();
    writer->SetCompressionLevel(9);
    writer->SetInputData(image);
    writer->Write();
    vtkUnsignedCharArray* const bytes = writer->GetResult();
    return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
            static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

/// Behind what the shared memory held.
json handed_back(const std::string& png, std::size_t at) {
    std::size_t sent = 0;
    while (sent < png.size()) {
        const ssize_t n = pwrite(io::samples_descriptor, png.data() + sent, png.size() - sent,
                                 static_cast<off_t>(at + sent));
        if (n <= 0) throw std::bad_alloc();
        sent += static_cast<std::size_t>(n);
    }
    return {{"at", at}, {"bytes", png.size()}};
}

json draw(const json& asked) {
    io::go_with_caller(asked.at("caller").get<pid_t>());
    const std::span<char> memory = shared_memory();
    std::vector<SurfaceArrays> arrays;
    const PictureScene scene = scene_from(text_in(memory), arrays);
    std::vector<SharedMesh> meshes;
    for (const SurfaceArrays& a : arrays) {
        meshes.push_back({array_in<float>(memory, a.positions), array_in<float>(memory, a.normals),
                          array_in<std::int32_t>(memory, a.triangles)});
    }
    vtkNew<Complaints> complaints;
    vtkOutputWindow::SetInstance(complaints);
    make_surfaceless_context();
    const auto pixels = pixels_of(scene, meshes);
    if (!complaints->first().empty()) {
        throw Failure("VTK complains: " + io::library_words(complaints->first(), 160));
    }
    return handed_back(png_from(pixels, scene.width, scene.height), memory.size());
}

json name_renderer(const json& asked) {
    io::go_with_caller(asked.at("caller").get<pid_t>());
    make_surfaceless_context(asked.at("machine").get<bool>() ? Driver::machine : Driver::software);
    return {{"renderer", renderer_name()}};
}

std::string words_of(const std::exception& e) {
    if (dynamic_cast<const Failure*>(&e)) return e.what();
    if (dynamic_cast<const std::bad_alloc*>(&e)) {
        return "not enough memory; draw a smaller picture of a smaller volume";
    }
    return io::library_words(e.what(), 300);
}

int run(int argc, char** argv) {
    const std::string job = argc == 3 ? argv[1] : "";
    const bool understood = job == "draw" || job == "graphics";
    const auto work = [&] {
        const json asked = json::parse(argv[2]);
        return job == "draw" ? draw(asked) : name_renderer(asked);
    };
    return io::helper_status("palpate-picture-helper", understood, work, words_of);
}

}  // namespace
}  // namespace palpate::pictures

int main(int argc, char** argv) {
    const int status = palpate::pictures::run(argc, argv);
    // No destructors of graphics libraries: what they free last is what they crash over.
    std::_Exit(status);
}
