// SPDX-License-Identifier: Apache-2.0
// Aravis' functions, found at run time, so that Fathom starts where there is no Aravis. Those of GLib
// that go with them are found through it.
#pragma once

#include <arv.h>

namespace fathom::aravis {

#define FATHOM_ARAVIS_FUNCTIONS(X)             \
  X(arv_update_device_list)                    \
  X(arv_get_n_devices)                         \
  X(arv_get_device_id)                         \
  X(arv_get_device_vendor)                     \
  X(arv_get_device_model)                      \
  X(arv_get_device_serial_nbr)                 \
  X(arv_get_device_protocol)                   \
  X(arv_get_device_address)                    \
  X(arv_camera_new)                            \
  X(arv_camera_get_device)                     \
  X(arv_camera_get_vendor_name)                \
  X(arv_camera_get_model_name)                 \
  X(arv_camera_create_stream)                  \
  X(arv_camera_start_acquisition)              \
  X(arv_camera_stop_acquisition)               \
  X(arv_camera_get_payload)                    \
  X(arv_camera_is_gv_device)                   \
  X(arv_camera_gv_set_packet_size)             \
  X(arv_camera_gv_set_packet_size_adjustment)  \
  X(arv_camera_is_software_trigger_supported)  \
  X(arv_camera_dup_available_triggers)         \
  X(arv_camera_dup_available_pixel_formats)    \
  X(arv_camera_get_pixel_format)               \
  X(arv_camera_set_pixel_format)               \
  X(arv_camera_is_frame_rate_available)        \
  X(arv_camera_get_frame_rate)                 \
  X(arv_camera_set_frame_rate)                 \
  X(arv_camera_is_exposure_time_available)     \
  X(arv_camera_get_exposure_time)              \
  X(arv_camera_set_exposure_time)              \
  X(arv_camera_get_exposure_time_bounds)       \
  X(arv_camera_is_gain_available)              \
  X(arv_camera_get_gain)                       \
  X(arv_camera_set_gain)                       \
  X(arv_camera_get_gain_bounds)                \
  X(arv_camera_is_feature_available)           \
  X(arv_camera_is_enumeration_entry_available) \
  X(arv_camera_execute_command)                \
  X(arv_camera_get_string)                     \
  X(arv_camera_set_string)                     \
  X(arv_camera_get_integer)                    \
  X(arv_camera_set_integer)                    \
  X(arv_camera_get_integer_bounds)             \
  X(arv_camera_get_integer_increment)          \
  X(arv_camera_get_float)                      \
  X(arv_camera_set_float)                      \
  X(arv_camera_get_float_bounds)               \
  X(arv_camera_get_float_increment)            \
  X(arv_device_error_quark)                    \
  X(arv_device_get_feature)                    \
  X(arv_gc_enumeration_get_type)               \
  X(arv_gc_float_get_type)                     \
  X(arv_gc_float_get_unit)                     \
  X(arv_gc_integer_get_type)                   \
  X(arv_gc_integer_get_unit)                   \
  X(arv_stream_push_buffer)                    \
  X(arv_stream_try_pop_buffer)                 \
  X(arv_stream_timeout_pop_buffer)             \
  X(arv_stream_get_statistics)                 \
  X(arv_buffer_new_allocate)                   \
  X(arv_buffer_get_status)                     \
  X(arv_buffer_get_timestamp)                  \
  X(arv_buffer_get_system_timestamp)           \
  X(arv_buffer_get_frame_id)                   \
  X(arv_buffer_get_image_data)                 \
  X(arv_buffer_get_image_pixel_format)         \
  X(arv_buffer_get_image_width)                \
  X(arv_buffer_get_image_height)               \
  X(arv_buffer_get_image_padding)              \
  X(g_type_check_instance_is_a)                \
  X(g_object_set)                              \
  X(g_object_unref)                            \
  X(g_signal_connect_data)                     \
  X(g_error_free)                              \
  X(g_free)

struct Api {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name
#define FATHOM_ARAVIS_MEMBER(name) decltype(&::name) name = nullptr;
  FATHOM_ARAVIS_FUNCTIONS(FATHOM_ARAVIS_MEMBER)
#undef FATHOM_ARAVIS_MEMBER
};

/// The functions of this machine's Aravis, found once. Throws Error(unavailable) where there is none.
const Api& api();

}  // namespace fathom::aravis
