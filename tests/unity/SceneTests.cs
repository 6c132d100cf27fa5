using System;
using System.Collections.Generic;
using System.Linq;
using Unity.Collections;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet.Tests
{
    /// What Unity would get: meshes, joints, avatars, characters.
    static class SceneTests
    {
        static AnthroCharacter Character(int finest = 1, int coarsest = 1)
        {
            var request = new AnthroRequest { Sex = AnthroSex.Male, Seed = 11 }.Set("height", 1.8);
            return AnthroFactory.Create(request, new AnthroSettings { finestLod = finest, coarsestLod = coarsest });
        }

        static int Joint(AnthroCharacter character, string name)
        {
            var place = Array.FindIndex(character.Rig.Bones, bone => bone.name == name);
            Expect.That(place >= 0, "no joint " + name);
            return place;
        }

        [Case("the left hand is at -X, the face at +Z, the feet on the floor")]
        static void Handedness()
        {
            var character = Character();
            var mesh = character.MeshOf(1);
            var left = character.Rig.Find("hand_l").localToWorldMatrix;
            var right = character.Rig.Find("hand_r").localToWorldMatrix;
            Expect.That(left.m03 < -0.4 && right.m03 > 0.4, "hands at x " + left.m03 + " and " + right.m03);
            Expect.That(left.m13 > 1.2, "a T-pose has its hands at the height of the shoulders, not at " + left.m13);
            // Vertices of the left hand are there, too.
            var bone = Joint(character, "hand_l");
            var at = 0;
            var xs = new List<float>();
            for (var v = 0; v < mesh.vertexCount; v++)
            {
                if (mesh.Weights[at].boneIndex == bone)
                {
                    xs.Add(mesh.Position(v).x);
                }
                at += mesh.BonesPerVertex[v];
            }
            Expect.That(xs.Count > 50 && xs.Max() < -0.4, xs.Count + " vertices of the hand up to x " + xs.Max());
            var toes = character.Rig.Find("ball_l").localToWorldMatrix;
            var ankle = character.Rig.Find("foot_l").localToWorldMatrix;
            Expect.That(toes.m23 > ankle.m23 + 0.05, "toes do not point to +Z");
            Expect.Near(0, mesh.bounds.min.y, 0.005, "the floor");
            Expect.Near(1.8, mesh.bounds.max.y, 0.03, "the crown");
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Case("triangles go round as Unity's: clockwise seen from outside")]
        static void Winding()
        {
            foreach (var lod in new[] { 0, 1, 2, 3 })
            {
                var character = Character(lod, lod);
                var mesh = character.MeshOf(lod);
                var part = mesh.GetSubMesh(0);
                int along = 0, against = 0;
                double volume = 0;
                for (var i = part.indexStart; i < part.indexStart + part.indexCount; i += 3)
                {
                    var corners = new[] { 0, 1, 2 }.Select(k => (int)mesh.Indices[i + k] + part.baseVertex).ToArray();
                    Vector3 a = mesh.Position(corners[0]), b = mesh.Position(corners[1]), c = mesh.Position(corners[2]);
                    // Unity's rule: in its left-handed space, Cross(b - a, c - a) points to where the face is seen from.
                    var face = Vector3.Cross(b - a, c - a);
                    if (Vector3.Dot(face, mesh.Normal(corners[0]) + mesh.Normal(corners[1]) + mesh.Normal(corners[2])) > 0)
                    {
                        along++;
                    }
                    else
                    {
                        against++;
                    }
                    volume += Vector3.Dot(a, Vector3.Cross(b, c)) / 6.0;
                }
                Expect.That(against * 50 < along, "LOD" + lod + ": " + against + " against, " + along + " along their normals");
                // Closed but for the mouth and eyes, so near the body's volume, with the sign of outward faces.
                Expect.Near(character.Body.Volume, volume, 0.05 * character.Body.Volume, "LOD" + lod + ": volume");
                UnityEngine.Object.Destroy(character.gameObject);
            }
        }

        [Case("bind pose x vertex = vertex, weights are sorted and of sum 1")]
        static void Binding()
        {
            foreach (var lod in new[] { 0, 1, 2, 3 })
            {
                var character = Character(lod, lod);
                var mesh = character.MeshOf(lod);
                var matrices = character.Rig.Bones
                    .Select((bone, i) => bone.localToWorldMatrix * mesh.bindposes[i]).ToArray();
                var at = 0;
                for (var v = 0; v < mesh.vertexCount; v++)
                {
                    var posed = Vector3.zero;
                    float sum = 0, last = 2;
                    int count = mesh.BonesPerVertex[v];
                    Expect.That(count >= 1 && count <= 4, "vertex " + v + " has " + count + " bones");
                    for (var k = 0; k < count; k++, at++)
                    {
                        var weight = mesh.Weights[at];
                        Expect.That(weight.weight > 0 && weight.weight <= last, "vertex " + v + ": not sorted");
                        last = weight.weight;
                        sum += weight.weight;
                        posed += matrices[weight.boneIndex].MultiplyPoint3x4(mesh.Position(v)) * weight.weight;
                    }
                    Expect.Near(1, sum, 1e-5, "sum of the weights of vertex " + v);
                    Expect.That((posed - mesh.Position(v)).magnitude < 1e-5, "vertex " + v + " moves in the bind pose");
                    Expect.Near(1, mesh.Normal(v).magnitude, 1e-3, "normal of vertex " + v);
                }
                UnityEngine.Object.Destroy(character.gameObject);
            }
        }

        [Case("sub-meshes cover their vertices and stay within them")]
        static void Parts()
        {
            using (var body = NativeTests.Body())
            using (var surface = new AnthroSurface(body, 1))
            {
                var mesh = AnthroMeshes.Create(surface, body.Joints(), "test");
                Expect.Equal(surface.PartCount, mesh.subMeshCount, "parts");
                Expect.That(Enumerable.Range(0, surface.PartCount).Select(i => surface.Part(i).name).Contains("Teeth"), "teeth");
                var vertex = 0;
                for (var i = 0; i < mesh.subMeshCount; i++)
                {
                    var part = mesh.GetSubMesh(i);
                    Expect.Equal(vertex, part.firstVertex, "first vertex");
                    Expect.Equal(vertex, part.baseVertex, "base vertex");
                    var used = mesh.Indices.Skip(part.indexStart).Take(part.indexCount).Distinct().ToArray();
                    Expect.That(used.Max() < part.vertexCount, "an index beyond part " + i);
                    Expect.Equal(part.vertexCount, used.Length, "used vertices of part " + i);
                    foreach (var index in used)
                    {
                        var p = mesh.Position(vertex + (int)index);
                        var over = Vector3.Max(p - part.bounds.max, part.bounds.min - p);
                        Expect.That(Math.Max(over.x, Math.Max(over.y, over.z)) < 1e-5, "outside of the bounds of part " + i);
                    }
                    vertex += part.vertexCount;
                }
                Expect.Equal(mesh.vertexCount, vertex, "vertices");
                Expect.That(mesh.Streams[1].All(uv => uv >= -0.001f && uv <= 1.001f), "texture coordinates beyond 0 to 1");
                UnityEngine.Object.Destroy(mesh);
            }
        }

        [Case("every bone that a humanoid requires is there, once, and the avatar is valid")]
        static void Humanoid()
        {
            var traits = HumanTrait.BoneName;
            var bones = AnthroHumanoid.Bones;
            Expect.Equal(55, bones.Count, "bones");
            foreach (var bone in bones)
            {
                Expect.That(traits.Contains(bone.trait), "Unity has no " + bone.trait);
                Expect.That(!HumanTrait.Required.Contains(bone.trait) || bone.required, bone.trait + " is required");
            }
            Expect.Equal(55, bones.Select(bone => bone.trait).Distinct().Count(), "different bones");
            Expect.Equal(55, bones.Select(bone => bone.joint).Distinct().Count(), "different joints");
            var character = Character(2, 3);
            var names = character.Rig.Bones.Select(bone => bone.name).Concat(new[] { "LOD2", "LOD3", character.name }).ToArray();
            Expect.Equal(names.Length, names.Distinct().Count(), "different names");
            Expect.That(character.Avatar != null && character.Avatar.isHuman, "avatar");
            Expect.That(character.GetComponent<Animator>().avatar == character.Avatar, "animator");
            var description = AnthroHumanoid.Describe(character.Rig, character.transform);
            Expect.Equal(character.Rig.Bones.Length + 1, description.skeleton.Length, "skeleton");
            Expect.That(description.human.All(bone => bone.limit.useDefaultValues), "limits");
            // A name that stands twice is told.
            var clash = new GameObject("pelvis");
            clash.transform.SetParent(character.transform, false);
            Debug.Errors.Clear();
            character.Generate();
            Expect.That(character.Avatar == null && Debug.Errors.Any(error => error.Contains("pelvis")), "a clash is not told");
            Debug.Errors.Clear();
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Case("levels of detail share one skeleton")]
        static void Levels()
        {
            var character = Character(0, 3);
            var lods = character.GetComponent<LODGroup>().GetLODs();
            Expect.Equal(4, lods.Length, "levels");
            var before = int.MaxValue;
            for (var lod = 0; lod < 4; lod++)
            {
                Expect.That(ReferenceEquals(character.RendererOf(lod).bones, character.Rig.Bones), "bones of LOD" + lod);
                Expect.That(ReferenceEquals(lods[lod].renderers[0], character.RendererOf(lod)), "renderer of LOD" + lod);
                var count = character.MeshOf(lod).vertexCount;
                Expect.That(count < before, "LOD" + lod + " has " + count + " vertices");
                before = count;
                Expect.Equal(character.MeshOf(lod).subMeshCount, character.RendererOf(lod).sharedMaterials.Length, "materials");
            }
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Case("a character becomes another in place, as if it were new")]
        static void Update()
        {
            var character = Character();
            var reports = 0;
            character.OnReport += made => reports++;
            var mesh = character.MeshOf(1);
            var root = character.Rig.Bones[0];
            character.Request.Set("height", 1.55).Set("waist_circumference", 1.0);
            character.Generate();
            Expect.Equal(1, reports, "reports");
            Expect.That(ReferenceEquals(mesh, character.MeshOf(1)) && ReferenceEquals(root, character.Rig.Bones[0]), "the same");
            var fresh = AnthroFactory.Create(character.Request, new AnthroSettings { finestLod = 1, coarsestLod = 1 });
            var other = fresh.MeshOf(1);
            Expect.That(mesh.Streams[0].SequenceEqual(other.Streams[0]), "positions and normals");
            Expect.That(mesh.Streams[1].SequenceEqual(other.Streams[1]), "texture coordinates");
            Expect.That(mesh.Indices.SequenceEqual(other.Indices), "triangles");
            Expect.That(mesh.Weights.SequenceEqual(other.Weights), "weights");
            Expect.That(mesh.BonesPerVertex.SequenceEqual(other.BonesPerVertex), "numbers of bones");
            Expect.That(mesh.bindposes.SequenceEqual(other.bindposes), "bind poses");
            Expect.That(character.Rig.Joints.SequenceEqual(fresh.Rig.Joints), "joints");
            // A refused request leaves it as it was.
            var body = character.Body;
            character.Request.Set("height", 9);
            Expect.Code(AnthroError.Request, "height", character.Generate, "too tall");
            Expect.That(ReferenceEquals(body, character.Body), "another body");
            Expect.Near(1.55, character.Body.Measures()[3].obtained, 1e-4, "height");
            UnityEngine.Object.Destroy(character.gameObject);
            Expect.Throws<ObjectDisposedException>(() => body.Joints(), "the body goes with its character");
            UnityEngine.Object.Destroy(fresh.gameObject);
        }

        [Case("after a reload of the code a character is made anew, not twice")]
        static void Reload()
        {
            var character = Character(2, 3);
            var children = character.transform.childCount;
            // What Unity does not serialise is as in a new component.
            var hidden = System.Reflection.BindingFlags.Instance | System.Reflection.BindingFlags.NonPublic;
            foreach (var name in new[] { "body", "rig", "avatar" })
            {
                typeof(AnthroCharacter).GetField(name, hidden).SetValue(character, null);
            }
            ((System.Collections.IList)typeof(AnthroCharacter).GetField("levels", hidden).GetValue(character)).Clear();
            AnthroModel.ReleaseDefault();
            character.Generate();
            Expect.Equal(children, character.transform.childCount, "children");
            Expect.That(character.Avatar != null && character.Rig.Find("pelvis") != null, "avatar");
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Case("awake generates, destroying leaves nothing")]
        static void Lifecycle()
        {
            // The materials are kept for the next ones: make them first.
            UnityEngine.Object.Destroy(Character().gameObject);
            var before = UnityEngine.Object.Alive;
            var home = new GameObject("person");
            var character = home.AddComponent<AnthroCharacter>();
            Expect.That(character.Body != null && character.MeshOf(0) != null && character.MeshOf(3) != null, "not generated");
            UnityEngine.Object.Destroy(home);
            Expect.Equal(before, UnityEngine.Object.Alive, "objects that are alive");
            Expect.Equal(0, Mesh.Pending, "mesh data");
            Expect.Equal(0, NativeArray<Vector3>.Alive + NativeArray<BoneWeight1>.Alive + NativeArray<byte>.Alive, "arrays");
        }

        [Case("blend shapes lead to the other body")]
        static void Shapes()
        {
            using (var heavy = AnthroModel.Default.Generate(new AnthroRequest { Sex = AnthroSex.Male, Seed = 11 }
                .Set("height", 1.8).Set("waist_circumference", 1.2)))
            {
                var character = Character();
                character.AddBlendShape("heavy", heavy);
                using (var surface = new AnthroSurface(heavy, 1))
                {
                    var other = AnthroMeshes.Create(surface, heavy.Joints(), "heavy");
                    var mesh = character.MeshOf(1);
                    var way = mesh.Shapes["heavy"];
                    for (var v = 0; v < mesh.vertexCount; v++)
                    {
                        Expect.That((mesh.Position(v) + way[v] - other.Position(v)).magnitude < 1e-5, "vertex " + v);
                    }
                    UnityEngine.Object.Destroy(other);
                }
                Expect.Code(AnthroError.Invalid, "", () => character.AddBlendShape("", heavy), "no name");
                character.Generate();
                Expect.Equal(0, character.MeshOf(1).blendShapeCount, "shapes of the body before");
                UnityEngine.Object.Destroy(character.gameObject);
            }
        }

        sealed class UniversalRenderPipelineAsset : RenderPipelineAsset { }

        sealed class HDRenderPipelineAsset : RenderPipelineAsset { }

        [Case("materials are those of the pipeline, and shared")]
        static void Materials()
        {
            var part = new AnthroPart { name = "Lashes", roughness = 0.8f, doubleSided = true, baseColor = new Color(0.5f, 0, 0, 1) };
            try
            {
                var builtIn = AnthroMaterials.Of(part);
                Expect.Equal("Standard", builtIn.shader.name, "Built-in");
                Expect.Near(0.735, ((Color)builtIn.Values["_Color"]).r, 0.001, "colour");
                Expect.Near(0.2, (float)builtIn.Values["_Glossiness"], 1e-6, "smoothness");
                GraphicsSettings.currentRenderPipeline = new UniversalRenderPipelineAsset();
                var universal = AnthroMaterials.Of(part);
                Expect.Equal("Universal Render Pipeline/Lit", universal.shader.name, "URP");
                Expect.That(universal.Values.ContainsKey("_BaseColor") && universal.Values.ContainsKey("_Cull"), "URP's");
                Expect.That(ReferenceEquals(universal, AnthroMaterials.Of(part)), "shared");
                GraphicsSettings.currentRenderPipeline = new HDRenderPipelineAsset();
                Expect.Equal("HDRP/Lit", AnthroMaterials.Of(part).shader.name, "HDRP");
                Shader.Known.Remove("HDRP/Lit");
                part.name = "Other";
                Expect.That(AnthroMaterials.Of(part) == null && Debug.Errors.Last().Contains("HDRP/Lit"), "a missing shader");
            }
            finally
            {
                GraphicsSettings.currentRenderPipeline = null;
                Shader.Known.Add("HDRP/Lit");
                Debug.Errors.Clear();
            }
        }

        [Case("characters spawn over frames, some fail, some are cancelled")]
        static void Spawn()
        {
            var requests = Enumerable.Range(1, 6).Select(i => new AnthroRequest { Seed = (ulong)i }).ToArray();
            requests[2].Set("height", 9);
            var settings = new AnthroSettings { finestLod = 2, coarsestLod = 3 };
            var told = new List<int>();
            var spawn = AnthroFactory.CreateAsync(requests, settings);
            requests[0].Set("height", 9);
            spawn.OnSpawned += (i, character) => told.Add(i);
            var frames = 0;
            while (!spawn.Advance(0))
            {
                frames++;
                Expect.That(frames < 1000000, "never done");
            }
            Expect.That(frames > 5 * 4, "only " + frames + " frames: a budget of nothing does one step a frame");
            Expect.Equal("0 1 3 4 5", string.Join(" ", told), "spawned");
            Expect.Equal(AnthroError.Request, spawn.Error(2).Code, "its error");
            Expect.That(spawn.Character(2) == null && spawn.Character(5).Body.Seed == 6, "characters");
            spawn.Dispose();
            foreach (var i in told)
            {
                UnityEngine.Object.Destroy(spawn.Character(i).gameObject);
            }
            var many = AnthroFactory.CreateAsync(Enumerable.Repeat(new AnthroRequest { Seed = 5 }, 200).ToArray(), settings);
            many.Cancel();
            while (!many.Advance(50))
            {
            }
            var whole = Enumerable.Range(0, 200).Count(i => many.Character(i) != null);
            Expect.That(whole < 200 && many.Error(199).Code == AnthroError.Cancelled, whole + " although cancelled");
            for (var i = 0; i < 200; i++)
            {
                UnityEngine.Object.Destroy(many.Character(i) == null ? null : many.Character(i).gameObject);
            }
            many.Dispose();
        }

        [Case("a spawn that is disposed of leaves nothing half made")]
        static void Halfway()
        {
            var spawn = AnthroFactory.CreateAsync(new[] { new AnthroRequest() }, new AnthroSettings { finestLod = 2 });
            var before = UnityEngine.Object.Alive;
            while (UnityEngine.Object.Alive == before)
            {
                spawn.Advance(0);
            }
            Expect.That(!spawn.IsDone, "it is done in one step");
            spawn.Dispose();
            spawn.Dispose();
            Expect.Equal(before, UnityEngine.Object.Alive, "objects that are alive");
            Expect.That(spawn.Advance(1) && spawn.Character(0) == null, "it goes on");
        }

        [Case("the samples run")]
        static void Samples()
        {
            var single = new GameObject("single").AddComponent<SingleCharacter>();
            MonoBehaviour.Tell(single, "Start");
            single.height = 1.9f;
            MonoBehaviour.Tell(single, "Update");
            var person = single.transform.GetChild(0).gameObject.GetComponent<AnthroCharacter>();
            Expect.Near(1.9, person.Body.Measures()[3].obtained, 1e-3, "height");
            MonoBehaviour.Tell(person.GetComponent<AnthroAnimator>(), "LateUpdate");
            UnityEngine.Object.Destroy(single.gameObject);

            var crowd = new GameObject("crowd").AddComponent<Crowd>();
            crowd.count = 12;
            MonoBehaviour.Tell(crowd, "Start");
            var runner = (AnthroRunner)typeof(AnthroRunner)
                .GetField("runner", System.Reflection.BindingFlags.Static | System.Reflection.BindingFlags.NonPublic).GetValue(null);
            var frames = 0;
            while (crowd.transform.childCount < 12 || frames < 20)
            {
                MonoBehaviour.Tell(runner, "Update");
                frames++;
            }
            var places = Enumerable.Range(0, 200).Select(i => Crowd.Position(i, 200, 1.2f)).ToArray();
            Expect.Equal(200, places.Distinct().Count(), "different places");
            MonoBehaviour.Tell(runner, "Update");
            UnityEngine.Object.Destroy(crowd.gameObject);
            AnthroRunner.Budget = 4.0;
        }

        [Case("the runner advances spawns each frame and frees them")]
        static void Running()
        {
            var spawn = AnthroRunner.Run(AnthroFactory.CreateAsync(
                new[] { new AnthroRequest() }, new AnthroSettings { finestLod = 3, coarsestLod = 3 }));
            var runner = (AnthroRunner)typeof(AnthroRunner)
                .GetField("runner", System.Reflection.BindingFlags.Static | System.Reflection.BindingFlags.NonPublic).GetValue(null);
            while (!spawn.IsDone)
            {
                MonoBehaviour.Tell(runner, "Update");
            }
            Expect.Throws<ObjectDisposedException>(spawn.Cancel, "it is not freed");
            UnityEngine.Object.Destroy(spawn.Character(0).gameObject);
        }

        [Case("the pool gives characters again")]
        static void Pool()
        {
            var pool = new AnthroPool();
            var settings = new AnthroSettings { finestLod = 3, coarsestLod = 3, pool = pool };
            var first = AnthroFactory.Create(new AnthroRequest { Seed = 1 }, settings);
            pool.Release(first);
            pool.Release(first);
            Expect.Equal(1, pool.Count, "in the pool");
            Expect.That(!first.gameObject.activeSelf, "asleep");
            var second = AnthroFactory.Create(new AnthroRequest { Seed = 2 }, settings);
            Expect.That(ReferenceEquals(first, second) && second.gameObject.activeSelf, "the same, awake");
            Expect.Equal(2ul, second.Body.Seed, "another person");
            pool.Release(second);
            UnityEngine.Object.Destroy(second.gameObject);
            Expect.That(pool.Take() == null, "a destroyed one is not given");
        }

        [Case("the animator poses the joints as the clip says")]
        static void Animate()
        {
            var character = Character(3, 3);
            var animator = character.gameObject.AddComponent<AnthroAnimator>();
            animator.Play("walk");
            animator.Advance(0.4f);
            var pose = new AnthroTransform[animator.Clip.JointCount];
            animator.Clip.Sample((double)0.4f, AnthroWrap.Loop, pose, true);
            for (var i = 0; i < pose.Length; i++)
            {
                var found = character.Rig.Bones[i].localToWorldMatrix;
                var off = new Vector3(found.m03, found.m13, found.m23) - pose[i].translation;
                Expect.That(off.magnitude < 1e-5, character.Rig.Bones[i].name + " is off by " + off);
            }
            var own = animator.Clip;
            animator.Play((AnthroClip)null);
            Expect.Throws<ObjectDisposedException>(() => own.Bake(), "its own clip is freed");
            character.Rig.ToBindPose();
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Case("skinning on the processor agrees with Unity's formula")]
        static void Skinning()
        {
            var character = Character(2, 2);
            var mesh = character.MeshOf(2);
            using (var clip = AnthroClip.Builtin("walk", character.Body))
            using (var surface = new AnthroSurface(character.Body, 2))
            using (var skinner = new AnthroSkinner(surface))
            using (var crowd = new AnthroCrowdSkin(new[] { skinner, skinner }, clip.JointCount))
            {
                crowd.Pose(0, clip, 0, AnthroWrap.Loop);
                crowd.Pose(1, clip, 0.35, AnthroWrap.Loop);
                crowd.Run();
                var pose = new AnthroTransform[clip.JointCount];
                clip.Sample(0.35, AnthroWrap.Loop, pose);
                character.Rig.ToPose(pose);
                var matrices = character.Rig.Bones
                    .Select((bone, i) => bone.localToWorldMatrix * mesh.bindposes[i]).ToArray();
                var at = 0;
                for (var v = 0; v < skinner.VertexCount; v++)
                {
                    var posed = Vector3.zero;
                    for (var k = 0; k < mesh.BonesPerVertex[v]; k++, at++)
                    {
                        posed += matrices[mesh.Weights[at].boneIndex].MultiplyPoint3x4(mesh.Position(v)) * mesh.Weights[at].weight;
                    }
                    var found = crowd.Positions[crowd.FirstVertex(1) + v];
                    Expect.That((posed - found).magnitude < 2e-5, "vertex " + v + ": " + posed + " and " + found);
                }
                Expect.Equal(2 * skinner.VertexCount, crowd.FirstVertex(crowd.Count), "vertices");
            }
            UnityEngine.Object.Destroy(character.gameObject);
        }
    }
}
