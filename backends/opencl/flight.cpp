// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/flight.hpp"

#include "backends/gpu/spectrum.hpp"

namespace fathom::opencl {
namespace {

constexpr cl_mem_flags kHostWrites = CL_MEM_READ_ONLY | CL_MEM_HOST_WRITE_ONLY;
constexpr cl_mem_flags kHostReads = CL_MEM_WRITE_ONLY | CL_MEM_HOST_READ_ONLY;

std::byte* map(Context& context, const Buffer& buffer, std::size_t bytes, cl_map_flags flags) {
  cl_int result = CL_SUCCESS;
  void* const mapped = cl().EnqueueMapBuffer(context.copies(), buffer.memory.get(), CL_TRUE, flags,
                                             0, bytes, 0, nullptr, nullptr, &result);
  context.check_alive(result, "mapping memory");
  return static_cast<std::byte*>(mapped);
}

}  // namespace

Staging::Staging(Context& context, std::size_t bytes, const char* what)
    : context_(&context),
      buffer_(context.buffer(bytes, CL_MEM_ALLOC_HOST_PTR, what)),
      data_(map(context, buffer_, bytes, CL_MAP_READ | CL_MAP_WRITE)) {}

Staging& Staging::operator=(Staging&& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(buffer_, other.buffer_);
  std::swap(data_, other.data_);
  return *this;
}

Staging::~Staging() {
  if (data_ == nullptr) return;
  cl().EnqueueUnmapMemObject(context_->copies(), buffer_.memory.get(), data_, 0, nullptr, nullptr);
  cl().Flush(context_->copies());  // or it stays until somebody copies next
}

Flight::Flight(Context& context, std::size_t windows, std::size_t words)
    : context_(context),
      windows_(context.buffer(4 * windows, kHostWrites, "a list of windows")),
      scores_(context.buffer(4 * words * windows, kHostReads, "scores")),
      doubtful_(context.buffer(4 + 4 * windows, CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS,
                               "a list of doubtful windows")),
      words_(words),
      origins_(context, 4 * windows, "a list of windows"),
      results_(context, 4 * words * windows, "scores") {}

void Flight::load(const Frame& frame, const gpu::Rectangle& part, std::span<const Window> windows,
                  std::span<const std::uint32_t> ids) {
  const std::size_t bytes = part.bytes(frame.depth());
  const bool is_unified = context_.physical().is_unified;
  if (bytes > frame_.bytes) {
    // First both, then in their place: if the second does not fit, the flight is as it was.
    Staging staging;
    if (!is_unified) staging = Staging(context_, bytes, "a frame to upload");
    frame_ =
        context_.buffer(bytes, kHostWrites | (is_unified ? CL_MEM_ALLOC_HOST_PTR : 0), "a frame");
    staging_ = std::move(staging);
  }
  frame_bytes_ = bytes;
  depth_ = frame.depth();
  is_uploaded_ = false;
  stride_words_ = static_cast<std::uint32_t>(part.stride_bytes(depth_) / 4);
  if (is_unified) {
    std::byte* const pixels = map(context_, frame_, bytes, CL_MAP_WRITE_INVALIDATE_REGION);
    part.copy(frame, pixels);
    context_.check_alive(cl().EnqueueUnmapMemObject(context_.copies(), frame_.memory.get(), pixels,
                                                    0, nullptr, nullptr),
                         "giving back memory");
  } else {
    part.copy(frame, staging_.data());
  }
  window_count_ = ids.empty() ? windows.size() : ids.size();
  std::uint32_t* const origins = origins_.words();
  for (std::size_t i = 0; i < window_count_; ++i) {
    origins[i] = part.origin(windows[ids.empty() ? i : ids[i]], depth_);
  }
}

/// In their own queue, whose last event tells the one that computes.
void Flight::upload() {
  const cl_command_queue copies = context_.copies();
  if (staging_.data() != nullptr) {
    context_.check_alive(
        cl().EnqueueWriteBuffer(copies, frame_.memory.get(), CL_FALSE, 0, frame_bytes_,
                                staging_.data(), 0, nullptr, nullptr),
        "copying pixels");
  }
  cl_event uploaded = nullptr;
  context_.check_alive(
      cl().EnqueueWriteBuffer(copies, windows_.memory.get(), CL_FALSE, 0, 4 * window_count_,
                              origins_.data(), 0, nullptr, &uploaded),
      "copying windows");
  uploaded_ = Handle<cl_event>(uploaded);
  context_.check_alive(cl().Flush(copies), "starting copies");
  context_.check_alive(cl().EnqueueBarrierWithWaitList(context_.queue(), 1, &uploaded, nullptr),
                       "waiting for copies");
}

void Flight::read(const Buffer& from, const Staging& to, std::size_t words) {
  cl_event done = nullptr;
  context_.check_alive(cl().EnqueueReadBuffer(context_.queue(), from.memory.get(), CL_FALSE, 0,
                                              4 * words, to.data(), 0, nullptr, &done),
                       "reading scores");
  done_ = Handle<cl_event>(done);
}

void Flight::enqueue(const Program& program, const Program* rescue, kernels::ScoreArgs args,
                     gpu::Wanted wanted) {
  args.stride_words = stride_words_;
  args.bytes_per_pixel = static_cast<std::uint32_t>(bytes_per_pixel(depth_));
  if (!is_uploaded_) upload();
  // What a kernel does not touch must be some buffer all the same.
  Program::Buffers buffers;
  buffers.fill(scores_.memory.get());
  buffers[FATHOM_FRAME] = frame_.memory.get();
  buffers[FATHOM_WINDOWS] = windows_.memory.get();
  buffers[FATHOM_DOUBTFUL] = doubtful_.memory.get();
  if (spectrum_.bytes > 0) buffers[FATHOM_SPECTRUM] = spectrum_.memory.get();
  constexpr cl_uint kNone = 0;
  context_.check_alive(cl().EnqueueFillBuffer(context_.queue(), doubtful_.memory.get(), &kNone,
                                              sizeof kNone, 0, sizeof kNone, 0, nullptr, nullptr),
                       "clearing a list");
  program.enqueue(buffers, args, window_count_, wanted);
  if (rescue != nullptr) rescue->enqueue_doubtful(buffers, args);
  if (wanted == gpu::Wanted::score) {
    read(scores_, results_, words_ * window_count_);
  } else {
    read(spectrum_, coefficients_, gpu::spectrum_words(program.spec().n));
  }
  context_.check_alive(cl().Flush(context_.queue()), "starting work");
}

void Flight::start(const Program& program, const Program* rescue, const kernels::ScoreArgs& args,
                   gpu::Wanted wanted) {
  if (wanted == gpu::Wanted::coefficients && spectrum_.bytes == 0) {
    const std::size_t bytes = sizeof(std::uint32_t) * gpu::spectrum_words(program.spec().n);
    coefficients_ = Staging(context_, bytes, "a spectrum");
    spectrum_ = context_.buffer(bytes, kHostReads, "a spectrum");
  }
  try {
    enqueue(program, rescue, args, wanted);
  } catch (...) {
    context_.drain();  // before the caller changes what the device may be using
    throw;
  }
  is_uploaded_ = true;
}

void Flight::finish() { context_.wait(done_.get(), window_count_); }

}  // namespace fathom::opencl
