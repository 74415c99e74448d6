#pragma once

// Meshes in PLY and glTF at the program's door, in bounded memory: what its tests share.

#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/stat.h>

#include "gltf_builder.h"
#include "program.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

namespace nuno {

struct BadFile {
  std::string name;
  std::string file;  ///< its name
  std::string content;
  std::string place;  ///< that the message names, after the file
  std::string value;  ///< that it shows
  std::string rule;   ///< that it says was broken
};

inline void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.name; }

inline const std::string ply_head = "ply\nformat ascii 1.0\n";
inline const std::string ply_vertices =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
inline const std::string ply_faces =
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
inline const std::string ply_body = "0 0 0\n1 0 0\n0 0 1\n1 0 1\n3 0 2 1\n3 1 2 3\n";
inline const std::string ply = ply_head + ply_vertices + ply_faces + ply_body;

inline std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  return text.replace(text.find(old), old.size(), fresh);
}

/// A folder within another, in which a secret is; a program that may take 1 GiB.
class MeshFormats : public Program {
 protected:
  MeshFormats() {
    const std::string secret = square_gltf().buffer;
    fs::create_directories(in_folder("shot/inner"));
    write_text(in_folder("secret.bin"), secret);
    fs::create_symlink(in_folder("secret.bin"), in_folder("shot/link.bin"));
    mkfifo(in_folder("shot/pipe.bin").c_str(), 0600);
    getrlimit(RLIMIT_AS, &limit_);
    if (is_sanitized) return;  // sanitizers take address space, not memory
    rlimit one_gib = limit_;
    one_gib.rlim_cur = 1 << 30;
    setrlimit(RLIMIT_AS, &one_gib);
  }
  ~MeshFormats() override { setrlimit(RLIMIT_AS, &limit_); }

  std::string in_shot(const std::string& name) const { return in_folder("shot/" + name); }

  Outcome thrown(const std::string& start, const std::string& target) const {
    return nuno({"throw", start, target, "--time", "1", "--out", output("flight.glb")});
  }

  /// Thrown onto itself, the file is refused where it should be, and nothing is written.
  void expect_refused(const BadFile& bad) const {
    const std::string path = in_shot(bad.file);
    write_text(path, bad.content);
    expect_refusal(thrown(path, path), path + bad.place + ": ", bad.value, bad.rule);
    EXPECT_TRUE(outputs().empty());
  }

 private:
  rlimit limit_{};
};

class MalformedMeshFormat : public MeshFormats, public testing::WithParamInterface<BadFile> {};

}  // namespace nuno
