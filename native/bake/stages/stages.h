// SPDX-License-Identifier: Apache-2.0
// The stages of a bake in order of execution; bake/run/stage_table.h has their names and their shares of the work,
// bake.cpp calls them. Most take the run, add their results to its job, and store finished work in the survey folder
// or the work folder, so that an interrupted bake resumes after it. The first pass over a capture from layers,
// Survey, has a header of its own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/report/report.h"
#include "bake/run/bake_run.h"
#include "bake/texels/colour_calibration.h"
#include "mattes/frame_reader.h"
#include "package/sound.h"

namespace fourdvt::bake {

class Survey;

// Validate: checks options, capture, output folder and disk space, before any long work.
// Opens the capture, encodes the base mesh and finds the bounds of all frames. Reads every mesh once, one at a time.
// `options.character_folder` has no trailing slash. Errors: InvalidArgument, WriteFailed, those of capture,
// Interrupted.
Result<Job> validate(const BakeOptions& options, const BakeEnvironment& environment);
// Encodes the base mesh and finds the bounds of all frames, from the current meshes of the job's capture; from cameras:
// planCameraSurfaces.
// Errors: those of capture, Interrupted, InvalidArgument.
Status planSurface(Job& job, const BakeEnvironment& environment);
constexpr double kVideoBytesPerTexel = 0.05;  // generous: crf 23 needs a fifth of it
// Errors: WriteFailed if the disk has no room for a character of this size and for the work folder.
Status checkSpace(const Job& job, double character_bytes);
// Sets job.length_scale from the frames' longest sides, unless an earlier call has, and with it the lengths that the
// options leave open. Errors: InvalidArgument if the bounds are too many position steps wide.
Status settleLengths(Job& job, std::vector<double> longest_sides_m);

// Side in texels of the largest texture that nearly every WebGL 2 device allows: players hold a mesh in such textures.
constexpr uint64_t kPlayersTextureSide = 4096;
// `file` names the mesh in messages. Errors: InvalidArgument.
Status checkLayeredMesh(const std::string& file, uint64_t vertices, uint64_t faces);
// Checks a surface as it will be streamed, after any simplification.
Status checkSurface(const std::string& file, uint64_t vertices, uint64_t faces);
// Path of the frame's mesh, for messages.
std::string meshFile(const capture::CaptureSequence& sequence, uint32_t frame);

// Refine: aligns meshes and cameras with the pictures before any other stage reads them (refine/refine.h). A
// refinement is stored in the survey folder under a key of the capture and of the options.

// FOLDER/refinement_<hash>.bin
std::string refinementPath(const std::string& folder, const capture::Capture& capture,
                           const refine::RefineOptions& options);
// Loads the refinement at `path`, or computes a new one. `on_progress`: see refineCapture. Errors: those of
// refineCapture.
Result<refine::Refinement> loadOrRefine(const std::string& path, const capture::Capture& capture,
                                        const refine::RefineOptions& options, const OpenVideo& open_video,
                                        const std::function<bool(const std::string& what, double share)>& on_progress);
// Errors: WriteFailed.
Status keepRefinement(const std::string& path, const refine::Refinement& refinement);
// Refines the run's capture, if its options select it, and plans again everything that depends on meshes and cameras.
Status refineJob(BakeRun& run);
// Stores the run's refinement, if there is one, for refineJob of the next run.
Status keepRefinement(const BakeRun& run);
// Adds the stored pictures of the job's refinement to it. False if they are missing.
bool loadRefinementPictures(Job& job);

// Regions, from cameras: the part of every camera's picture that shows the surfaces, and the sequences' tiles.

// Reads every surface once, one at a time, after the sequences' first ones: a tiled picture that is too large is
// reported as early as possible. Sets job.regions, job.bounds and job.mesh, the first surface. Errors: those of
// capture, NothingVisible, InvalidArgument, Interrupted.
Status planCameraSurfaces(Job& job, const BakeEnvironment& environment);
// The surface of a frame as it is streamed, before quantisation of its positions.
TriangleMesh streamedSurface(const Job& job, const mattes::CaptureFrame& frame);
// Completes job.streams: one per captured sequence. Errors: InvalidArgument (the tiled picture is too large).
Status planCameraStreams(BakeRun& run);

// Warp, from layers: plans the sequences of the character, one per captured sequence, then one per motion class.

// Completes job.streams and grows job.bounds by the classes' interpolated meshes. Errors: those of planClass and
// rootTrack, InvalidArgument (a class's picture is too large), Interrupted.
Status planStreams(BakeRun& run);
// The classes that are baked; none if options.classes.bake is off.
std::vector<const capture::CaptureClass*> bakedClasses(const Job& job);
// Number of phases of a class: the frames of its longest member.
uint32_t expectedPhases(const Job& job, const capture::CaptureClass& motion_class);

// Colours, from cameras: calibrates the cameras' colours, as the survey does for layers, on surfaces whose topology
// may change. One map per camera; empty without calibration. Stored in the survey folder. Errors: those of capture
// and GPU, WriteFailed, Interrupted.
Result<std::vector<ColourMap>> calibrateColours(BakeRun& run);

// Method: chooses the rendering method of a character from cameras by leave-one-out trials
// (bake/method/method_trial.h): in a few frames, each camera (if there are many, a few that lie far apart) is left out
// in turn and rendered from the others. Results per frame are stored in the survey folder. Memory: one frame. maps: one
// per camera, or none.

constexpr uint32_t kTrialFrames = 3;  // spread over the sequences of the whole capture
// Returns the method that the options name, if any, without trials. Errors: those of capture, tryMethods, WriteFailed,
// Interrupted.
Result<ChosenMethod> chooseBakedMethod(BakeRun& run, const std::vector<ColourMap>& maps);
// Number of frames that chooseBakedMethod tries; 0 without a measurement.
uint32_t triedFrames(const Job& job);
// Sequence index and frame of the `number`-th tried frame.
std::pair<size_t, uint32_t> triedFrame(const Job& job, uint32_t number);
// Tries the methods on the `number`-th tried frame, and stores the results.
Status tryMethodsOn(BakeRun& run, const std::vector<ColourMap>& maps, uint32_t number);

// Resample, Fill, Tile, Encode, Geometry: all GOPs that the work folder lacks. From layers: resamples, fills, tiles and
// encodes, and codes the chunks of plain sequences. From cameras: crops, corrects colours (maps: one per camera, or
// none), fills, tiles and encodes, and codes the surfaces as a chunk. Memory: two frames of pictures, one GOP of meshes
// and packets. Errors: those of capture, GPU and encoder, WriteFailed, Interrupted.

// Returns the number of frames that this run has baked.
Result<uint32_t> bakeGops(BakeRun& run, const Survey& survey);
Result<uint32_t> bakeGops(BakeRun& run, const std::vector<ColourMap>& maps);
// Bakes one GOP. Layers that classes show stay in the work folder.
Status bakeGop(BakeRun& run, const Survey& survey, const StreamPlan& plan, uint32_t gop);
Status bakeGop(BakeRun& run, const std::vector<ColourMap>& maps, const StreamPlan& plan, uint32_t gop);

// Align: aligns the decoded pictures of classes whose GOPs are encoded, and codes their chunks. Measured phases are
// stored in the work folder. Sets the detail correlation in the classes' plans. Errors: GpuFailure, VideoInvalid,
// WriteFailed, Interrupted.
Status alignClasses(BakeRun& run);
// Aligns one class.
Status alignClass(BakeRun& run, StreamPlan& plan);
// Measures the phases of one finished GOP of a class.
Status alignGop(BakeRun& run, const StreamPlan& plan, uint32_t gop);

// Graph: builds the motion graph of the whole character. Its states are the streams in the manifest's order.

// The weights at which transitions of a class are measured: every member alone, and three mixtures of every pair of
// neighbours (with one parameter, neighbours by its value; with two, all pairs). For a plain sequence: {{1}}.
std::vector<std::vector<float>> graphWeights(const ClassPlan& plan);
// Returns the bytes of the graph's file, empty for a character of one stream. Stored in the work folder. Requires all
// GOPs to be finished. Errors: those of capture, Interrupted.
Result<std::vector<uint8_t>> makeGraph(BakeRun& run);

// Room: the texture of the room in capture.json, from the cameras' plates.

struct BakedRoom {
  package::Room room;            // complete; the picture's name without its hash
  std::vector<uint8_t> picture;  // bytes of the file that it names
};
// Rejects a room that does not hold the performer in all frames, and one without plates. Errors: CaptureJson, those
// of mattes::readRoomPlate.
Status checkRoom(const Job& job);
// Makes the room's picture; empty if the capture has no room. `colour_maps`: one per camera, or none. Errors: those of
// mattes::readRoomPlate, Internal.
Result<std::optional<BakedRoom>> makeRoom(BakeRun& run, const std::vector<ColourMap>& colour_maps);

// Sound, a part of Assemble: reads the sound of sequences and of classes' footsteps, aligned with the pictures' time,
// cuts it into segments and encodes these. Memory: one segment of samples, and the encoded file.

// Opens every sound of the job; sounds that are never audible are listed in job.notes. Errors: those of AudioReader,
// CaptureJson (a sound that lies outside its sequence).
Status checkSounds(Job& job, const BakeEnvironment& environment);
// Writes the files of all streams that have sound into the result folder, and their bytes into the report. Errors:
// those of AudioReader and encodeSegment, WriteFailed, Interrupted; those of reading meshes.
Result<package::Sounds> writeSounds(BakeRun& run, ReportInput& report);

// Assemble: makes the character folder from finished GOPs, completely in a sibling folder, which bake.cpp then
// publishes.

struct Assembly {
  std::vector<uint8_t> graph;   // bytes of the motion graph's file; empty without a graph
  std::vector<ColourMap> maps;  // from cameras: see bakeGops; applied to the poster's pictures, too
  std::optional<BakedRoom> room;
};
// Writes every file but the report's into job.resultFolder(), and pictures of the report alone into
// job.reportFolder(); completes `report` (sequences, codec, pictures, bytes by part). Errors: WriteFailed, Internal,
// GpuFailure.
Status assemble(BakeRun& run, const Assembly& parts, ReportInput& report);
// Writes report.json, report.html and the character's pictures that they show into job.reportFolder().
Status writeReportFiles(const Job& job, const ReportInput& report);

}  // namespace fourdvt::bake
