using System;
using UnityEngine;

namespace Anthronet
{
    /// <summary>The joints of a character as transforms, called as in the rig. On the main thread alone.</summary>
    public sealed class AnthroRig
    {
        readonly Transform[] bones;
        readonly AnthroJoint[] joints;

        AnthroRig(Transform[] bones, AnthroJoint[] joints)
        {
            this.bones = bones;
            this.joints = joints;
        }

        /// <summary>The transforms, parents first; the first is the root.</summary>
        public Transform[] Bones
        {
            get { return bones; }
        }

        /// <summary>The joints of the body in the bind pose.</summary>
        public AnthroJoint[] Joints
        {
            get { return joints; }
        }

        /// <summary>Makes the transforms of a body's joints below a transform, in the bind pose.</summary>
        public static AnthroRig Create(AnthroBody body, Transform parent)
        {
            var joints = body.Joints();
            var bones = new Transform[joints.Length];
            for (var i = 0; i < joints.Length; i++)
            {
                bones[i] = new GameObject(body.JointName(i)).transform;
                bones[i].SetParent(joints[i].parent < 0 ? parent : bones[joints[i].parent], false);
            }
            var rig = new AnthroRig(bones, joints);
            rig.ToBindPose();
            return rig;
        }

        /// <summary>Takes transforms that are there already, in the bind pose of a body.</summary>
        /// <param name="body">The body.</param>
        /// <param name="root">The transform of its first joint; the others are below it.</param>
        /// <returns>Null where not all joints are there; nothing is changed then.</returns>
        internal static AnthroRig Adopt(AnthroBody body, Transform root)
        {
            var joints = body.Joints();
            var bones = new Transform[joints.Length];
            for (var i = 0; i < joints.Length; i++)
            {
                var parent = joints[i].parent;
                bones[i] = parent >= 0 ? bones[parent].Find(body.JointName(i)) : root;
                if (bones[i] == null || bones[i].name != body.JointName(i))
                {
                    return null;
                }
            }
            var rig = new AnthroRig(bones, joints);
            rig.ToBindPose();
            return rig;
        }

        /// <summary>Where a joint is below the character, as animation curves name it: `Root/pelvis/…`.</summary>
        public string Path(int joint)
        {
            var path = bones[joint].name;
            for (var parent = joints[joint].parent; parent >= 0; parent = joints[parent].parent)
            {
                path = bones[parent].name + "/" + path;
            }
            return path;
        }

        /// <summary>Gives the transforms the proportions of another body, in its bind pose.</summary>
        public void Update(AnthroBody body)
        {
            body.Joints(joints);
            ToBindPose();
        }

        /// <summary>Puts the transforms into the bind pose.</summary>
        public void ToBindPose()
        {
            for (var i = 0; i < bones.Length; i++)
            {
                bones[i].localPosition = joints[i].local.translation;
                bones[i].localRotation = joints[i].local.rotation;
            }
        }

        /// <summary>Puts the transforms into a pose relative to the parents. Makes no garbage.</summary>
        public void ToPose(AnthroTransform[] pose)
        {
            if (pose.Length != bones.Length)
            {
                throw new ArgumentException("expected " + bones.Length + " joints, got " + pose.Length, "pose");
            }
            for (var i = 0; i < bones.Length; i++)
            {
                bones[i].localPosition = pose[i].translation;
                bones[i].localRotation = pose[i].rotation;
            }
        }

        /// <summary>The index of a joint by its name in the rig; −1 where the rig has no such joint.</summary>
        public int IndexOf(string joint)
        {
            return Array.FindIndex(bones, bone => bone.name == joint);
        }

        /// <summary>The transform of a joint by its name in the rig; null where the rig has no such joint.</summary>
        public Transform Find(string joint)
        {
            return Array.Find(bones, bone => bone.name == joint);
        }
    }
}
