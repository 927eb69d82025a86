// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/drivers.hpp"

#include <cstdlib>

#include "engine/device_list.hpp"
#include "engine/file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/gpu/layered.hpp"

namespace fathom {
namespace {

class Drivers : public ::testing::Test {
 protected:
  std::string folder() const { return gpu::folder_identity(folder_.path(), ".json"); }
  test::TemporaryFolder folder_;
};

TEST_F(Drivers, AreOthersWhenTheirFilesChange) {
  EXPECT_EQ(folder(), "");
  write_file(folder_ / "a.json", R"({"ICD": {"library_path" : "./liba.so"}})");
  const std::string without_library = folder();
  write_file(folder_ / "liba.so", "1");
  const std::string first = folder();
  EXPECT_NE(first, without_library);
  EXPECT_EQ(first, folder());
  write_file(folder_ / "liba.so", "22");
  EXPECT_NE(folder(), first) << "another library";
  const std::string second = folder();
  write_file(folder_ / "b.json", "{}");
  EXPECT_NE(folder(), second) << "another manifest";
  const std::string third = folder();
  write_file(folder_ / "readme.txt", "no manifest");
  EXPECT_EQ(folder(), third);
}

TEST_F(Drivers, AreNamedByTheirManifests) {
  const auto named = [&](const char* file, const std::string& text) {
    write_file(folder_ / file, text);
    return gpu::library_named(folder_ / file);
  };
  EXPECT_EQ(named("a.json", R"({"library_path": "/opt/liba.so"})"), "/opt/liba.so");
  EXPECT_EQ(named("a.json", R"({"library_path":"../liba.so"})"), folder_ / "../liba.so");
  EXPECT_EQ(named("a.json", R"({"library_path": "libnowhere.so"})"), "libnowhere.so");
  EXPECT_EQ(named("a.icd", "/opt/liba.so\n"), "/opt/liba.so");
  for (const char* damaged :
       {"", "{", R"({"library_path")", R"({"library_path": )", R"({"library_path": "liba)"}) {
    EXPECT_EQ(named("a.json", damaged), "") << damaged;
  }
  EXPECT_EQ(gpu::library_named(folder_ / "missing.json"), "");
}

TEST_F(Drivers, AreFoundThroughVariables) {
  setenv("FATHOM_TEST_PATHS", ":/a::/b/c:", 1);
  EXPECT_EQ(gpu::paths_in("FATHOM_TEST_PATHS"), (std::vector<std::filesystem::path>{"/a", "/b/c"}));
  unsetenv("FATHOM_TEST_PATHS");
  EXPECT_TRUE(gpu::paths_in("FATHOM_TEST_PATHS").empty());
  const std::string before = gpu::machine_identity();
  setenv("POCL_DEVICES", "fathom-test", 1);
  EXPECT_NE(gpu::machine_identity(), before);
  unsetenv("POCL_DEVICES");
  EXPECT_EQ(gpu::machine_identity(), before);
}

class KnownDevices : public test::OnEveryGpuBackend {};
FATHOM_ON_EVERY_GPU_BACKEND(KnownDevices);

TEST_P(KnownDevices, AreAsTheDriversSaidWithoutThem) {
  EXPECT_NE(backend().drivers(), "");
  const test::TemporaryFolder folder;
  const char* const old = std::getenv("FATHOM_CACHE");
  const std::string kept = old != nullptr ? old : "";
  setenv("FATHOM_CACHE", folder.path().c_str(), 1);
  const auto listed = known_devices(backend(), {});
  layer().pretends_to_be_gpu = true;  // which only the driver would say
  const auto known = known_devices(backend(), {});
  old != nullptr ? setenv("FATHOM_CACHE", kept.c_str(), 1) : unsetenv("FATHOM_CACHE");
  ASSERT_EQ(known.size(), listed.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(known[i].name, listed[i].name);
    EXPECT_EQ(known[i].kind, listed[i].kind);
    EXPECT_EQ(known[i].details, listed[i].details);
  }
  open();  // of Vulkan: takes the connection that listing has left
}

}  // namespace
}  // namespace fathom
